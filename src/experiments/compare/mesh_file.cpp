#include <algorithm>
#include <cmath>
#include <filesystem>

#include "experiments/compare/cells.h"
#include "experiments/compare/mesh.h"
#include "palpate/core/error.h"
#include "store/csv.h"

namespace palpate::compare {
namespace {

namespace fs = std::filesystem;
using store::CsvCell;

std::string unit_of(const MeshComparison& c) { return c.tool ? "n" : "m"; }

/// Returns names and cells of one level, in the order of the columns.
std::vector<std::pair<std::string, CsvCell>> cells_of(const MeshComparison& c, const MeshVariable& v,
                                                      const MeshLevel& level) {
  const bool ran = level.status == Status::kOk;
  const auto number = [ran](auto value) { return CsvCell(ran ? static_cast<double>(value) : kEmpty); };
  std::vector<std::pair<std::string, CsvCell>> out = {{"scene", c.scene},
                                                      {"resolution", v.name},
                                                      {"divisions", static_cast<double>(level.divisions)},
                                                      {"size", number(level.size)},
                                                      {"elements", number(level.elements)},
                                                      {"nodes", number(level.nodes)},
                                                      {"surface_vertices", number(level.surface_vertices)},
                                                      {"most_samples", number(level.most_samples)}};
  for (std::size_t q = 0; q < c.figures.size(); ++q) {
    const bool has = q < level.values.size();
    const std::string name = fmt::format("{}_{}", c.figures[q] == "RMS" ? "rms" : c.figures[q], unit_of(c));
    out.emplace_back(name, has ? level.values[q].value : kEmpty);
    out.emplace_back("time_error_" + name, has ? level.values[q].time_error : kEmpty);
    const GridEstimate* limit = q < v.errors.size() ? &v.errors[q].limit : nullptr;
    out.emplace_back("error_" + name, has && limit ? std::abs(level.values[q].value - limit->value) : kEmpty);
  }
  out.emplace_back("from_finest_rms_" + unit_of(c), level.from_finest);
  out.emplace_back("step_s", v.step_s > 0.0 ? v.step_s : kEmpty);
  out.emplace_back("cpu_s", number(level.cpu_s));
  out.emplace_back("setup_s", number(level.setup_s));
  out.emplace_back("status", std::string(to_string(level.status)));
  out.emplace_back("reason", level.reason);
  return out;
}

double share(double part, double whole) { return whole > 0.0 ? part / whole : kEmpty; }

/// Returns the value at the scene's resolution; NaN where that did not run.
double own_value(const MeshVariable& v, std::size_t figure) {
  for (const MeshLevel& level : v.levels)
    if (level.divisions == 0 && figure < level.values.size()) return level.values[figure].value;
  return kEmpty;
}

std::string name_of(const MeshComparison& c, std::size_t figure) {
  const std::string& name = c.figures[figure];
  const std::string quantity = c.tool ? "force" : "displacement";
  if (name == "hold" || name == "end") return fmt::format("{} at {:g} s", quantity, c.hold_s);
  return fmt::format("{} {}", name, quantity);
}

/// Returns the error of one figure as a sentence; empty where there is no estimate.
std::string sentence(const MeshComparison& c, const MeshVariable& v, std::size_t figure) {
  const MeshError& e = v.errors[figure];
  const double own = own_value(v, figure);
  if (!std::isfinite(e.error) || !(own > 0.0)) return "";
  const std::string what =
      v.name == kTogether ? "elements, skin and contact points together" : "the " + v.name;
  if (e.limit.kind == Convergence::kEqual)
    return fmt::format("{}: refining {} has no effect: the levels are equal", name_of(c, figure), what);
  std::string out = fmt::format("{} {:.4g} {}: {:+.2g} % +- {:.2g} % due to {}", name_of(c, figure), own,
                                c.unit(), 100.0 * e.error / own, 100.0 * e.limit.uncertainty / own, what);
  out += std::isfinite(e.limit.order)
             ? fmt::format(" (order {:.2f}, {})", e.limit.order, to_string(e.limit.kind))
             : fmt::format(" ({})", to_string(e.limit.kind));
  if (!e.is_resolved())
    out += fmt::format("; the time error is {:.2g} of the difference between levels, more than a tenth",
                       e.time_share);
  return out;
}

}  // namespace

std::vector<std::string> in_words(const MeshComparison& c) {
  const bool together = std::any_of(c.variables.begin(), c.variables.end(), [](const MeshVariable& v) {
    return v.name == kTogether && v.unchanged.empty();
  });
  std::vector<std::string> out, others;
  for (const MeshVariable& v : c.variables) {
    if (!v.unchanged.empty()) {
      if (v.name != kTogether)
        others.push_back(fmt::format("{}: not refined, because {}", v.name, v.unchanged));
      continue;
    }
    // All figures of the whole error, and the first of each part.
    const bool whole = v.name == kTogether || !together;
    for (std::size_t q = 0; q < v.errors.size() && (whole || q == 0); ++q)
      if (std::string one = sentence(c, v, q); !one.empty()) (whole ? out : others).push_back(std::move(one));
  }
  out.insert(out.end(), others.begin(), others.end());
  return out;
}

void write(const MeshComparison& c, const std::string& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) fail("{}: the results' folder cannot be created: {}", folder, failed.message());
  std::vector<std::string> columns;
  for (const auto& [name, cell] : cells_of(c, {}, {})) columns.push_back(name);
  store::CsvWriter csv((fs::path(folder) / "mesh.csv").string(), columns);
  for (const MeshVariable& v : c.variables)
    for (const MeshLevel& level : v.levels) {
      if (level.status == Status::kMissing) continue;  // Stopped before it.
      std::vector<CsvCell> row;
      for (auto& [name, cell] : cells_of(c, v, level)) row.push_back(std::move(cell));
      csv.row(row);
    }
  csv.close();
}

void add_to_summary(store::Summary& summary, const MeshComparison& c) {
  summary.remarks = in_words(c);
  store::SummaryFields& about = summary.section("mesh").values;
  about = {{"made_by", c.made_by}, {"rules", c.rules}};
  if (c.hold_s > 0.0) about.emplace_back(c.tool ? "hold_s" : "end_s", c.hold_s);
  const std::string unit = unit_of(c);
  for (const MeshVariable& v : c.variables) {
    for (const MeshLevel& level : v.levels) {
      store::SummaryFields row;
      for (const auto& [name, cell] : cells_of(c, v, level)) {
        if (const double* number = std::get_if<double>(&cell)) {
          if (std::isfinite(*number)) row.emplace_back(name, *number);
        } else if (const std::string* text = std::get_if<std::string>(&cell); text && !text->empty()) {
          row.emplace_back(name, *text);
        }
      }
      summary.list("mesh_levels").push_back(std::move(row));
    }
    for (std::size_t q = 0; q < v.errors.size(); ++q) {
      const MeshError& e = v.errors[q];
      const double own = own_value(v, q);
      if (!std::isfinite(own)) continue;
      summary.list("mesh_errors")
          .push_back({{"resolution", v.name},
                      {"figure", name_of(c, q)},
                      {"value_" + unit, own},
                      {"estimate_" + unit, e.limit.value},
                      {"uncertainty_" + unit, e.limit.uncertainty},
                      {"error_" + unit, e.error},
                      {"error_of_value", share(e.error, own)},
                      {"uncertainty_of_value", share(e.limit.uncertainty, own)},
                      {"order", e.limit.order},
                      {"convergence", to_string(e.limit.kind)},
                      {"time_error_of_difference", e.time_share}});
    }
  }
}

}  // namespace palpate::compare
