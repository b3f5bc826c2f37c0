#include "palpate/report/page.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "inline_svg.h"
#include "palpate/core/error.h"
#include "palpate/core/markup.h"
#include "palpate/report/table.h"
#include "palpate/store/atomic_file.h"
#include "style.h"

namespace palpate::report {
namespace {

namespace fs = std::filesystem;

/// A cell longer than this may break over lines; shorter ones never do.
constexpr std::size_t kLongCell = 48;

const char* class_of(RowMark mark) {
  switch (mark) {
    case RowMark::kGood: return " class=\"good\"";
    case RowMark::kBad: return " class=\"bad\"";
    case RowMark::kFaint: return " class=\"faint\"";
    case RowMark::kNone: break;
  }
  return "";
}

std::string figure(const std::string& content, const std::string& caption) {
  return "<figure>\n" + content +
         (caption.empty() ? "" : "\n<figcaption>" + escape_html(caption) + "</figcaption>") + "\n</figure>\n";
}

/// Beside other tables, short values stand to the right, so that numbers line up.
std::string facts_table(const Page::Facts& facts, bool short_to_the_right) {
  std::string table = "<table class=\"facts\"><tbody>\n";
  for (const auto& [name, value] : facts)
    table += fmt::format("<tr><th>{}</th><td{}>{}</td></tr>\n", escape_html(name),
                         value.size() > kLongCell ? " class=\"w\""
                         : short_to_the_right     ? " class=\"n\""
                                                  : "",
                         escape_html(value));
  return table + "</tbody></table>\n";
}

}  // namespace

std::string escape_html(const std::string& text) { return escape_markup(text); }

Page::Page(std::string title) : title_(std::move(title)) {}

Page& Page::add_heading(const std::string& text, int level) {
  PALPATE_CHECK(level >= 2 && level <= 3, "heading level {}", level);
  body_ += fmt::format("<h{0}>{1}</h{0}>\n", level, escape_html(text));
  return *this;
}

Page& Page::add_paragraph(const std::string& text) {
  body_ += "<p>" + escape_html(text) + "</p>\n";
  return *this;
}

Page& Page::add_table(const std::vector<std::string>& headers,
                      const std::vector<std::vector<std::string>>& rows, const std::string& caption,
                      const std::vector<RowMark>& marks) {
  PALPATE_CHECK(marks.empty() || marks.size() == rows.size(), "{} marks for {} rows", marks.size(),
                rows.size());
  for (const auto& row : rows)
    PALPATE_CHECK(row.size() == headers.size(), "a row of {} cells under {} headers", row.size(),
                  headers.size());
  std::vector<const char*> classes;
  for (std::size_t c = 0; c < headers.size(); ++c)
    classes.push_back(is_numeric_column(rows, c) ? " class=\"n\"" : "");
  body_ += "<div class=\"scroll\"><table>\n";
  if (!caption.empty()) body_ += "<caption>" + escape_html(caption) + "</caption>\n";
  body_ += "<thead><tr>";
  for (std::size_t c = 0; c < headers.size(); ++c)
    body_ += fmt::format("<th{}>{}</th>", classes[c], escape_html(headers[c]));
  body_ += "</tr></thead>\n<tbody>\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    body_ += fmt::format("<tr{}>", marks.empty() ? "" : class_of(marks[r]));
    for (std::size_t c = 0; c < headers.size(); ++c)
      body_ += fmt::format("<td{}>{}</td>", rows[r][c].size() > kLongCell ? " class=\"w\"" : classes[c],
                           escape_html(rows[r][c]));
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
  return *this;
}

Page& Page::add_facts(const Facts& facts) {
  if (!facts.empty()) body_ += "<div class=\"scroll\">" + facts_table(facts, false) + "</div>\n";
  return *this;
}

Page& Page::add_fact_groups(const std::vector<std::pair<std::string, Facts>>& groups) {
  body_ += "<div class=\"groups\">\n";
  for (const auto& [name, facts] : groups)
    body_ += "<section>\n<h3>" + escape_html(name) + "</h3>\n" + facts_table(facts, true) + "</section>\n";
  body_ += "</div>\n";
  return *this;
}

Page& Page::add_svg(const std::string& svg, const std::string& caption) {
  body_ += figure(inline_svg(svg, fmt::format("f{}-", ++figures_)), caption);
  return *this;
}

Page& Page::add_png(const fs::path& png, const std::string& caption) {
  std::ifstream in(png, std::ios::binary);
  if (!in) fail("{}: cannot be opened for reading; check the path and its permissions", png.string());
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (!bytes.starts_with("\x89PNG\r\n\x1a\n"))
    fail("{}: is not a PNG file; only PNG pictures can be embedded", png.string());
  body_ += figure("<img alt=\"" + escape_html(caption.empty() ? png.stem().string() : caption) +
                      "\" src=\"data:image/png;base64," + base64(bytes) + "\"/>",
                  caption);
  return *this;
}

Page& Page::add_missing_figure(const std::string& caption, const std::string& why) {
  missing_figures_.push_back({caption, why});
  return add_paragraph("Figure not drawn (" + caption + "): " + why);
}

Page& Page::add_fragment(const std::string& html) {
  body_ += html;
  return *this;
}

Page& Page::add_code(const std::string& text) {
  body_ += "<pre><code>" + escape_html(text) + "</code></pre>\n";
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

std::string Page::html() const {
  const std::string title = escape_html(title_);
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>" +
         title + "</title>\n<style>" + kStyleSheet + "</style>\n</head>\n<body>\n<h1>" + title + "</h1>\n" +
         body_ + "</body>\n</html>\n";
}

void write(const Page& page, const fs::path& path) { store::write_atomically(path.string(), page.html()); }

}  // namespace palpate::report
