#include "report/page.h"

#include <algorithm>

#include "core/markup.h"
#include "embedded_scripts.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "style.h"

namespace palpate::report {
namespace {

namespace fs = std::filesystem;

std::string list_item(const std::string& text) { return "<li>" + escape_html(text) + "</li>\n"; }

}  // namespace

std::string escape_html(const std::string& text) { return escape_markup(text); }

Page::Page(std::string title) : title_(std::move(title)) {}

Page& Page::add_heading(const std::string& text, int level) {
  PALPATE_CHECK(level >= 2 && level <= 3, "heading level {}", level);
  body_ += fmt::format("<h{0}>{1}</h{0}>\n", level + level_, escape_html(text));
  return *this;
}

Page& Page::add_paragraph(const std::string& text) {
  body_ += "<p>" + escape_html(text) + "</p>\n";
  return *this;
}

Page& Page::add_answer(const std::vector<Answer>& answers) {
  if (std::all_of(answers.begin(), answers.end(), [](const Answer& a) { return a.empty(); })) return *this;
  body_ += "<div class=\"answer\">\n";
  for (const Answer& answer : answers) {
    if (!answer.lead.empty()) add_paragraph(answer.lead);
    if (answer.points.empty()) continue;
    body_ += "<ul>\n";
    for (const std::string& point : answer.points) body_ += list_item(point);
    body_ += "</ul>\n";
  }
  body_ += "</div>\n";
  return *this;
}

Page& Page::add_fragment(const std::string& html) {
  body_ += html;
  return *this;
}

Page& Page::add_code(const std::string& text) {
  body_ += "<pre><code>" + escape_html(text) + "</code></pre>\n";
  return *this;
}

Page& Page::begin_lead() {
  body_ += "<div class=\"lead\">\n";
  return *this;
}

Page& Page::end_lead() {
  body_ += "</div>\n";
  return *this;
}

Page& Page::begin_multiples() {
  body_ += "<div class=\"multiples\">\n";
  return *this;
}

Page& Page::end_multiples() {
  body_ += "</div>\n";
  return *this;
}

Page& Page::begin_details(const std::string& summary) {
  body_ += "<details>\n<summary>" + escape_html(summary) + "</summary>\n";
  return *this;
}

Page& Page::end_details() {
  body_ += "</details>\n";
  return *this;
}

Page& Page::begin_part(const std::string& id, const std::string& title) {
  PALPATE_CHECK(level_ == 0, "part \"{}\" inside a part", id);
  body_ += "<section class=\"part\" id=\"" + escape_html(id) + "\">\n";
  add_heading(title);
  level_ = 1;
  return *this;
}

Page& Page::end_part() {
  level_ = 0;
  body_ += "</section>\n";
  return *this;
}

Page& Page::add_contents(const std::vector<Link>& links) {
  body_ += "<nav aria-label=\"Contents\"><ol>\n";
  for (const Link& link : links)
    body_ += fmt::format("<li><a href=\"#{}\">{}</a><span>{}</span></li>\n", escape_html(link.id),
                         escape_html(link.title), escape_html(link.answer));
  body_ += "</ol></nav>\n";
  return *this;
}

std::string Page::html() const {
  const std::string title = escape_html(title_);
  std::string scripts;
  // CDATA keeps the page well-formed XML with its scripts
  const auto add = [&](std::string_view script) {
    scripts += fmt::format("<script>/*<![CDATA[*/\n{}/*]]>*/</script>\n", script);
  };
  if (interacts_) add(page_script());
  if (turns_) {
    add(three_script());
    add(view_script());
  }
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>" +
         title + "</title>\n<style>" + kStyleSheet + "</style>\n</head>\n<body>\n<main>\n<h1>" + title +
         "</h1>\n" + body_ + "</main>\n" + scripts + "</body>\n</html>\n";
}

void write(const Page& page, const fs::path& path) { store::write_atomically(path.string(), page.html()); }

}  // namespace palpate::report
