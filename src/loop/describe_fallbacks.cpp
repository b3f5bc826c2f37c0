#include "loop/describe_fallbacks.h"

#include <fmt/format.h>

#include <vector>

namespace palpate::loop {

std::string describe_fallbacks(const dynamics::StepperCounters& c) {
  std::vector<std::string> out;
  if (c.halved_steps > 0)
    out.push_back(fmt::format("{} steps divided into {} parts, the smallest 1/{} of a step", c.halved_steps,
                              c.step_parts, 1L << c.most_halvings));
  const auto add = [&](long count, const char* what) {
    if (count > 0) out.push_back(fmt::format("{} {}", count, what));
  };
  add(c.definite_retries, "solves repeated with positive definite tangents");
  add(c.leaps, "solves repeated with undamped Newton corrections");
  add(c.downhill, "proximal steps");
  add(c.indefinite, "indefinite matrices");
  add(c.lu, "matrices factored by LU");
  add(c.unconverged, "unconverged iterative solves replaced by a factorisation");
  add(c.clamped, "clamped element tangents");
  add(c.rounding_limited, "equilibria limited by rounding");
  return fmt::format("{}", fmt::join(out, ", "));
}

}  // namespace palpate::loop
