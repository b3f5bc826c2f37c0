#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"
#include "report/page.h"
#include "report/table.h"

namespace palpate::report {
namespace {

/// Longest cell that is never broken over lines.
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

/// Returns whether a column can be sorted by the number at the beginning of each cell.
bool sorts_as_numbers(const Rows& rows, std::size_t column) {
  bool any = false;
  for (const auto& row : rows) {
    std::string cell = row[column];
    if (is_blank(cell)) continue;
    if (cell.starts_with("<= ")) cell.erase(0, 3);
    if (std::isnan(to_number(cell.substr(0, cell.find(' '))))) return false;
    any = true;
  }
  return any;
}

/// Returns a table of facts. Next to other tables, short values are aligned to the right, so that numbers
/// line up.
std::string facts_table(const Page::Facts& facts, bool short_to_the_right) {
  std::string table = "<table class=\"facts\"><tbody>\n";
  for (const auto& [name, value] : facts)
    table += fmt::format("<tr><th>{}</th><td{}>{}</td></tr>\n", escape_html(name),
                         value.size() > kLongCell ? " class=\"w\""
                         : short_to_the_right     ? " class=\"n\""
                                                  : "",
                         escape_html(shown_cell(value)));
  return table + "</tbody></table>\n";
}

}  // namespace

Page& Page::add_table(const std::vector<std::string>& headers, const Rows& rows, const std::string& caption,
                      const std::vector<RowMark>& marks) {
  PALPATE_CHECK(marks.empty() || marks.size() == rows.size(), "{} marks for {} rows", marks.size(),
                rows.size());
  for (const auto& row : rows)
    PALPATE_CHECK(row.size() == headers.size(), "a row of {} cells under {} headers", row.size(),
                  headers.size());
  std::vector<const char*> classes;
  for (std::size_t c = 0; c < headers.size(); ++c)
    classes.push_back(is_numeric_column(rows, c) ? " class=\"n\"" : "");
  interacts_ |= rows.size() > 1;
  // a scrollable region must be reachable by keyboard
  body_ += fmt::format(
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"table: {}\">"
      "<table class=\"sortable\">\n",
      escape_html(headers.empty() ? "" : headers[0]));
  if (!caption.empty()) body_ += "<caption><span>" + escape_html(caption) + "</span></caption>\n";
  body_ += "<thead><tr>";
  for (std::size_t c = 0; c < headers.size(); ++c)
    body_ += fmt::format("<th{} scope=\"col\" data-sort=\"{}\">{}</th>", classes[c],
                         sorts_as_numbers(rows, c) ? "number" : "text", escape_html(headers[c]));
  body_ += "</tr></thead>\n<tbody>\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    body_ += fmt::format("<tr{}>", marks.empty() ? "" : class_of(marks[r]));
    for (std::size_t c = 0; c < headers.size(); ++c)
      body_ += fmt::format("<td{}>{}</td>", rows[r][c].size() > kLongCell ? " class=\"w\"" : classes[c],
                           escape_html(shown_cell(rows[r][c])));
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

}  // namespace palpate::report
