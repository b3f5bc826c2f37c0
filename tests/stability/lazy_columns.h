#pragma once
#include <fmt/format.h>

#include <map>
#include <string>
#include <vector>

#include "stability/lazy_stepper.h"
#include "stability/stability.h"

namespace palpate::lazy {

struct Named {
  std::string name;
  const dynamics::StepperRegistry& (*registry)();
};
inline void PrintTo(const Named& lazy, std::ostream* out) { *out << lazy.name; }

inline std::vector<Named> all() {
  return {{"only_the_clock", registry<Laziness::kOnlyTheClock>}, {"refuses", registry<Laziness::kRefuses>}};
}

/// Returns the fraction of the stepper cells that a lazy stepper in every column satisfies; prints it row by
/// row. (The tool's ticks are not in the registry, and excluded.)
inline double satisfied_share(const Named& lazy, stability::StabilityOptions options) {
  options.registry = lazy.registry;
  struct Count {
    int satisfied = 0, cells = 0;
    void add(bool is) { satisfied += is, ++cells; }
  };
  std::vector<std::pair<std::string, Count>> rows;
  Count whole;
  for (const stability::StabilityCell& cell : stability::run(options).cells) {
    if (cell.integrator.starts_with("tool: ")) continue;
    if (rows.empty() || rows.back().first != cell.row) rows.push_back({cell.row, {}});
    rows.back().second.add(cell.as_expected());
    whole.add(cell.as_expected());
  }
  fmt::print("{}: cells that it satisfies\n", lazy.name);
  for (const auto& [row, count] : rows)
    fmt::print("  {:22} {:4} of {:4}\n", row, count.satisfied, count.cells);
  fmt::print("  {:22} {:4} of {:4}\n", "all", whole.satisfied, whole.cells);
  return whole.cells > 0 ? static_cast<double>(whole.satisfied) / whole.cells : 1.0;
}

}  // namespace palpate::lazy
