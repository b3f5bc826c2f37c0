#include "cases.h"
#include "e_oscillator.h"

// Semi-implicit Euler on m x'' = -k x - b x':
//     z^2 - (2 - (h^2 k + h b)/m) z + 1 - h b/m = 0
// has a root on the unit circle at z = -1, where k = 4 m/h^2 - 2 b/h.  Backward Euler:
//     (m + h b + h^2 k) z^2 - (2 m + h b) z + m = 0
// has both roots inside for every k > 0.

namespace palpate::validation {
namespace {

constexpr double kTick = 1e-3;

bool bounded(const std::string& scheme, double k, double b) {
  ToolSpec spec = desktop_tool(scheme);
  spec.coupling.stiffness_n_m = k;
  spec.coupling.damping_n_s_m = b;
  tool::Tool body(spec, Vec3::Zero());
  body.set_state(0.0, {Quat::Identity(), Vec3(1e-6, 0, 0)}, {});
  for (int i = 0; i < 3000; ++i) {
    if (!body.advance(kTick, {}, {}).ok()) return false;
    if (body.pose().translation.norm() > 1e-3) return false;
  }
  return true;
}

double largest_stable(const std::string& scheme, double b) {
  double low = 1e3, high = 1e7;
  while (high / low > 1.003) {
    const double k = std::sqrt(low * high);
    (bounded(scheme, k, b) ? low : high) = k;
  }
  return low;
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const double m = desktop_tool("semi-implicit-euler").mass_kg;
  for (double b : {0.0, 40.0}) {
    const double exact = 4 * m / (kTick * kTick) - 2 * b / kTick;
    const double found = largest_stable("semi-implicit-euler", fault == "forgotten-damping" ? 0.0 : b);
    out.push_back({.quantity = fmt::format("semi-implicit-euler: largest stable k, b = {} N s/m [N/m]", b),
                   .computed = found,
                   .exact = exact,
                   .error = std::abs(found / exact - 1.0),
                   .bar = 0.02});
  }
  const std::string scheme =
      fault == "explicit-as-implicit" ? "semi-implicit-euler" : "linearly-implicit-euler";
  double unstable = 0;
  for (double k : {1e2, 1e4, 1e6, 1e8, 1e10, 1e12}) unstable += !bounded(scheme, k, 0.0);
  out.push_back({.quantity = "linearly-implicit-euler: unstable among k = 1e2 .. 1e12 N/m, b = 0 [count]",
                 .computed = unstable,
                 .error = unstable,
                 .bar = 0.0});
  return out;
}

}  // namespace

ValidationCase coupling_limit() {
  return {
      .name = "coupling-limit",
      .section = "E",
      .summary =
          "largest stable coupling stiffness at a tick of 1 ms: 4 m/h^2 - 2 b/h semi-implicit, none implicit",
      .why =
          "the stiffness of a virtual wall is bounded by the coupling's; which scheme bounds it, and where, "
          "must be known beforehand",
      .run = run,
      .faults = {"forgotten-damping", "explicit-as-implicit"}};
}

}  // namespace palpate::validation
