#include <algorithm>
#include <array>
#include <map>

#include "heat_map.h"
#include "palpate/core/error.h"
#include "sections.h"

namespace palpate::report {
namespace {

struct VerdictName {
  const char* name;
  const char* letter;
  const char* meaning;
};
constexpr std::array<VerdictName, 9> kVerdicts = {
    {{"accurate", "A", "within the theoretical error bound of the exact solution"},
     {"stable", "S", "energy and motion never exceed the input"},
     {"bounded", "B", "energy or motion exceeds the input, within a bound"},
     {"error", "E", "ended early with a message that gives the reason"},
     {"grew", "G", "exceeded all bounds and reported success"},
     {"not finite", "N", "returned a result that is not finite"},
     {"silent", "F", "failed without a reason, or omitted a required report"},
     {"too slow", "T", "stopped at the time limit"},
     {"wrong", "W", "contradicts physics or the formula of the method"}}};

std::size_t index_of(const std::string& verdict) {
  std::size_t v = 0;
  while (v + 1 < kVerdicts.size() && verdict != kVerdicts[v].name) ++v;
  return v;
}

std::string expected_text(const Json& cell) {
  std::string out;
  if (cell.contains("expected"))
    for (const Json& name : cell["expected"]) out += (out.empty() ? "" : " or ") + name.get<std::string>();
  return out;
}

HeatCell heat_cell(const Json& cell) {
  const std::size_t v = index_of(text_at(cell, "verdict"));
  HeatCell out;
  out.letter = kVerdicts[v].letter;
  out.css = fmt::format("v{}", v);
  out.outlined = !cell.value("as_expected", false);
  const std::string reason = text_at(cell, "reason");
  out.title = fmt::format("{}, {}\n{}: {} (expected: {})\n{}{}\n{} steps, {} s of CPU", text_at(cell, "row"),
                          text_at(cell, "sub_case"), text_at(cell, "integrator"), kVerdicts[v].name,
                          expected_text(cell), text_at(cell, "figure"), reason.empty() ? "" : "\n" + reason,
                          short_number(number_at(cell, "steps")), short_number(number_at(cell, "cpu_s")));
  return out;
}

/// Heat map: the integrators in the order of their first appearance as columns, and the rows as groups.
struct HeatMap {
  std::vector<std::string> columns;
  std::vector<HeatGroup> groups;
  std::map<std::string, std::size_t> column_of;

  void add_columns(const std::vector<const Json*>& cells) {
    for (const Json* cell : cells) {
      const std::string name = text_at(*cell, "integrator");
      if (column_of.try_emplace(name, columns.size()).second) columns.push_back(name);
    }
  }
  void add(const Json& cell, const std::map<std::string, std::string>& summaries) {
    const std::string row = text_at(cell, "row"), sub_case = text_at(cell, "sub_case");
    if (groups.empty() || groups.back().name != row)
      groups.push_back({row, summaries.contains(row) ? summaries.at(row) : "", {}, {}});
    HeatGroup& group = groups.back();
    if (group.rows.empty() || group.rows.back() != sub_case) {
      group.rows.push_back(sub_case);
      group.cells.emplace_back(columns.size());
    }
    group.cells.back()[column_of.at(text_at(cell, "integrator"))] = heat_cell(cell);
  }
};

/// Groups cells by rows with the same integrators, which share a map: rows of soft bodies, and rows of the
/// ticks of the tool.
std::vector<std::vector<const Json*>> parted(const Json& cells) {
  std::vector<std::vector<const Json*>> parts;
  std::map<std::string, std::size_t> part_of_integrator;
  for (const Json& cell : cells) {
    const std::string row = text_at(cell, "row"), integrator = text_at(cell, "integrator");
    std::size_t part = parts.size();
    for (std::size_t p = 0; p < parts.size(); ++p)
      if (text_at(*parts[p].back(), "row") == row) part = p;
    if (const auto known = part_of_integrator.find(integrator);
        part == parts.size() && known != part_of_integrator.end())
      part = known->second;
    if (part == parts.size()) parts.emplace_back();
    part_of_integrator.try_emplace(integrator, part);
    parts[part].push_back(&cell);
  }
  return parts;
}

void add_unexpected(Page& page, const Json& cells) {
  Rows rows;
  for (const Json& cell : cells)
    if (!cell.value("as_expected", false))
      rows.push_back({text_at(cell, "row"), text_at(cell, "sub_case"), text_at(cell, "integrator"),
                      text_at(cell, "verdict"), expected_text(cell), text_at(cell, "figure"),
                      text_at(cell, "reason")});
  if (rows.empty()) return;
  page.add_heading("Cells that differ from theory", 3);
  page.add_table({"row", "case", "integrator", "verdict", "expected", "figure", "reason"}, rows, "",
                 std::vector<RowMark>(rows.size(), RowMark::kBad));
}

void add_ends(Page& page, const Json& cells) {
  Rows rows;
  for (const Json& cell : cells)
    if (text_at(cell, "verdict") == "error" && cell.value("as_expected", false))
      rows.push_back({text_at(cell, "row"), text_at(cell, "sub_case"), text_at(cell, "integrator"),
                      text_at(cell, "reason")});
  if (rows.empty()) return;
  page.begin_details("Messages of cells that ended early");
  page.add_table({"row", "case", "integrator", "message"}, rows);
  page.end_details();
}

}  // namespace

void add_stability(Page& page, const Json& stability) {
  if (!stability.is_object() || !stability.contains("cells") || !stability["cells"].is_array() ||
      stability["cells"].empty())
    return;
  const Json& cells = stability["cells"];
  std::map<std::string, std::string> summaries;
  if (stability.contains("rows"))
    for (const Json& row : stability["rows"]) summaries[text_at(row, "name")] = text_at(row, "summary");

  page.add_heading("Stability");
  page.add_paragraph(
      "Stiff and extreme cases against every integrator. The expected verdicts of each cell follow from "
      "theory; a cell with any other verdict is outlined. The figure, expected verdicts and reason of a cell "
      "are shown under the pointer, and below the map when the cell is clicked or selected with the arrow "
      "keys.");
  add_unexpected(page, cells);
  std::vector<HeatCell> key;
  for (std::size_t v = 0; v < kVerdicts.size(); ++v)
    key.push_back({kVerdicts[v].letter, fmt::format("v{}", v),
                   fmt::format("{}: {}", kVerdicts[v].name, kVerdicts[v].meaning)});
  key.push_back({"A", "v0", "outlined: differs from theory", true});
  page.add_fragment(heat_key_html(key));
  for (const auto& part : parted(cells)) {
    HeatMap map;
    map.add_columns(part);
    for (const Json* cell : part) map.add(*cell, summaries);
    page.add_fragment(heat_map_html(map.columns, map.groups));
  }
  add_ends(page, cells);
}

}  // namespace palpate::report
