#include "palpate/loop/silent_doings.h"

#include <fmt/format.h>

#include <vector>

namespace palpate::loop {

std::string silent_doings(const dynamics::StepperCounters& c) {
  std::vector<std::string> out;
  if (c.halved_steps > 0)
    out.push_back(fmt::format("{} steps taken in {} parts, the smallest 1/{}", c.halved_steps, c.step_parts,
                              1L << c.most_halvings));
  const auto add = [&](long count, const char* what) {
    if (count > 0) out.push_back(fmt::format("{} {}", count, what));
  };
  add(c.definite_retries, "solves tried again with definite tangents");
  add(c.leaps, "solves without descent");
  add(c.downhill, "steps downhill in energy");
  add(c.indefinite, "indefinite matrices");
  add(c.lu, "matrices left to LU");
  add(c.unconverged, "linear solves given up by the iteration");
  add(c.clamped, "element tangents bounded");
  add(c.rounding_limited, "equilibria limited by rounding");
  return fmt::format("{}", fmt::join(out, ", "));
}

}  // namespace palpate::loop
