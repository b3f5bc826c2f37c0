#include <algorithm>
#include <map>
#include <set>

#include "palpate/core/error.h"
#include "sections.h"

/// Section for the output of `palpate bench -o`: JSON whose lists of objects become tables, whatever their
/// columns.
namespace palpate::report {
namespace {

/// Returns the heading of a list of the benchmarks.
std::string name_of(const std::string& key) {
  static const std::map<std::string, std::string> names = {{"rows", "Steps, by stages"},
                                                           {"elements", "Loops over elements"},
                                                           {"limits", "Limits of the machine"},
                                                           {"points", "Error against run time"},
                                                           {"prices", "Cost of contact relative to a step"},
                                                           {"bars", "Acceptance limits"}};
  const auto known = names.find(key);
  return known == names.end() ? key_text(key) : known->second;
}

/// Appends the cells of an object in the order of its keys; a nested object has names as "outer, inner".
void flatten(const Json& object, const std::string& prefix,
             std::vector<std::pair<std::string, std::string>>& out) {
  for (const auto& [key, value] : object.items()) {
    const std::string name = prefix + key_text(key);
    if (value.is_object())
      flatten(value, name + ", ", out);
    else if (!value.is_array() || value.empty() || !value[0].is_object())
      out.emplace_back(name, value_text(value));
  }
}

bool is_list_of_objects(const Json& value) {
  return value.is_array() && !value.empty() && value[0].is_object();
}

void add_list(Page& page, const std::string& name, const Json& list) {
  std::vector<std::string> headers;
  std::vector<std::map<std::string, std::string>> lines;
  std::set<std::string> known;
  for (const Json& one : list) {
    std::vector<std::pair<std::string, std::string>> cells;
    flatten(one, "", cells);
    for (const auto& [header, cell] : cells)
      if (known.insert(header).second) headers.push_back(header);
    lines.emplace_back(cells.begin(), cells.end());
  }
  Rows rows;
  for (const auto& line : lines) {
    rows.emplace_back();
    for (const std::string& header : headers) {
      const auto cell = line.find(header);
      rows.back().push_back(cell == line.end() || cell->second.empty() ? "-" : cell->second);
    }
  }
  page.add_heading(name, 3);
  page.add_table(headers, rows);
}

/// Chart of two figures of a list.
struct ListChart {
  const char *list, *x, *y, *x_label, *y_label, *caption;
  std::string (*name_of)(const Json& one);  ///< Name of the line of an entry
};

std::string name_of_step(const Json& row) {
  const double threads = number_at(row, "threads");
  return fmt::format(
      "E {} Pa, {} ms, {}, {}, {} thread{}", short_number(number_at(row, "youngs_modulus_pa"), 6),
      short_number(1e3 * number_at(row, "step_s")), short_number(number_at(row, "linear_rtol")),
      text_at(row, "linear_solver"), short_number(threads), threads > 1.0 ? "s" : "");
}

std::string name_of_program(const Json& point) {
  const double step_s = number_at(point, "step_s");
  const bool quoted = point.value("quoted", false);
  return text_at(point, "program") + (quoted         ? " (quoted)"
                                      : step_s > 0.0 ? fmt::format(", {} ms", short_number(1e3 * step_s))
                                                     : "");
}

constexpr ListChart kStepTimes = {"rows",
                                  "nodes",
                                  "step_ms",
                                  "nodes",
                                  "time of a step, median [ms]",
                                  "Time of one linearly implicit step over the size of the body.",
                                  name_of_step};
constexpr ListChart kErrors = {"points",
                               "ms_of_ten_ms",
                               "error",
                               "run time of 10 ms of motion, one thread [ms]",
                               "error of the final state, relative [-]",
                               "Fall of the beam: error against run time.",
                               name_of_program};

/// Adds the lists inside an object, each under the names of the enclosing keys.
void add_lists(Page& page, const std::string& path, const Json& value) {
  if (value.is_object())
    for (const auto& [key, inner] : value.items())
      add_lists(page, path.empty() ? key_text(key) : path + ": " + key_text(key), inner);
  if (!is_list_of_objects(value)) return;
  const auto own = [&](const Json& one) {
    const std::string scene = text_at(one, "scene", text_at(one, "with"));
    return scene.empty() ? path : path + ", " + scene;
  };
  std::vector<std::pair<std::string, std::string>> cells;
  for (const Json& one : value)
    if (one.is_object()) flatten(one, "", cells);
  if (cells.size() > value.size()) add_list(page, path, value);  // objects with more than a name
  for (const Json& one : value)
    if (one.is_object())
      for (const auto& [key, inner] : one.items())
        if (is_list_of_objects(inner)) add_lists(page, own(one) + ": " + key_text(key), inner);
}

/// Adds a chart of two figures of a list, with both axes logarithmic and one line for each name.
void add_chart(Page& page, const std::string& file, const Json& bench, const ListChart& chart) {
  if (!bench.contains(chart.list) || !bench[chart.list].is_array()) return;
  Plot plot = log_log_plot(chart.x_label, chart.y_label);
  std::map<std::string, Series> series;
  for (const Json& one : bench[chart.list]) {
    Series& line = series[chart.name_of(one)];
    line.x.push_back(number_at(one, chart.x));
    line.y.push_back(number_at(one, chart.y));
  }
  for (auto& [name, line] : series) {
    line.name = name;
    line.mark = Mark::kLinePoints;
    plot.series.push_back(std::move(line));
  }
  if (!plot.series.empty()) add_plot(page, plot, file, chart.caption);
}

}  // namespace

void add_bench(Page& page, const std::string& file, const Json& bench) {
  page.add_heading("Benchmark: " + file);
  page.add_facts(facts_of(bench));
  if (file == "bench-fem.json") add_chart(page, file, bench, kStepTimes);
  if (file == "bench-fem-accuracy.json") add_chart(page, file, bench, kErrors);
  std::vector<std::string> keys;
  for (const auto& [key, value] : bench.items()) keys.push_back(key);
  // the limits of the machine, which support the figures, come after them
  std::stable_partition(keys.begin(), keys.end(), [](const std::string& key) { return key != "limits"; });
  for (const std::string& key : keys) add_lists(page, name_of(key), bench[key]);
}

}  // namespace palpate::report
