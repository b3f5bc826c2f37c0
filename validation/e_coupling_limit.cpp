#include "cases.h"
#include "device/arm_axis.h"
#include "e_faulty_tool.h"
#include "e_oscillator.h"

// Problem: largest stable stiffness of the virtual coupling at a tick h.
//
// Exact answer. Semi-implicit Euler on m x'' = -k x - b x':
//     z^2 - (2 - (h^2 k + h b)/m) z + 1 - h b/m = 0
// has a root on the unit circle at z = -1, where k = 4 m/h^2 - 2 b/h. Backward Euler:
//     (m + h b + h^2 k) z^2 - (2 m + h b) z + m = 0
// has both roots inside for every k > 0.
//
// Force held over the tick, as by motors: the handle, with mass m, is coupled to a fixed tool and moves
// exactly under f = -(k x0 + b v0), evaluated at the start of the tick,
//     v1 = v0 + h f/m,   x1 = x0 + h v0 + h^2 f/(2 m):   trace 2 - h^2 k/(2 m) - h b/m,
//                                                         determinant 1 - h b/m + h^2 k/(2 m).
// The determinant is the stricter condition as long as b h < 2 m: below 1 where k < 2 b/h. This bounds the
// damping, not the mass; without damping no k is stable.
//
// Measured: the limit, by bisection on whether the motion is bounded, to 2 %.

namespace palpate::validation {
namespace {

constexpr double kTick = 1e-3;

constexpr const char* kHeld = "force held over the tick";

ToolSpec coupled(const std::string& scheme, double k, double b) {
  ToolSpec spec = desktop_tool(scheme);
  spec.coupling.stiffness_n_m = k;
  spec.coupling.damping_n_s_m = b;
  return spec;
}

/// Returns whether the motion is bounded: the tool is fixed, and the handle moves under the coupling force
/// evaluated at the start of each tick.
bool bounded_held(double k, double b, const std::string& fault) {
  const ToolSpec spec = coupled("linearly-implicit-euler", k, b);
  const FaultyTool body(spec, fault);
  device::ArmAxis handle({.mass = spec.mass_kg});
  handle.place(1e-6, 0.0);
  double before = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double force = body.wrench_on_hand({Quat::Identity(), Vec3(handle.x(), 0, 0)},
                                             {Vec3::Zero(), Vec3(handle.v(), 0, 0)})
                             .force.x();
    handle.advance(kTick, fault == "force-of-last-tick" ? before : force,
                   fault == "force-of-last-tick" ? before : force);
    before = force;
    if (!(std::abs(handle.x()) < 1e-3)) return false;
  }
  return true;
}

bool bounded(const std::string& scheme, double k, double b, const std::string& fault) {
  if (scheme == kHeld) return bounded_held(k, b, fault);
  FaultyTool body(coupled(scheme, k, b), fault);
  body.set_state(0.0, {Quat::Identity(), Vec3(1e-6, 0, 0)}, {});
  for (int i = 0; i < 3000; ++i) {
    if (!body.advance(kTick, {}, {}).ok()) return false;
    if (body.pose().translation.norm() > 1e-3) return false;
  }
  return true;
}

double largest_stable(const std::string& scheme, double b, const std::string& fault) {
  double low = 1e2, high = 1e7;
  while (high / low > 1.003) {
    const double k = std::sqrt(low * high);
    (bounded(scheme, k, b, fault) ? low : high) = k;
  }
  return low;
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const double m = desktop_tool("semi-implicit-euler").mass_kg;
  const auto add = [&](const std::string& scheme, double b, double exact) {
    const double found = largest_stable(scheme, b, fault);
    out.push_back({.quantity = fmt::format("{}: largest stable k, b = {} N s/m [N/m]", scheme, b),
                   .computed = found,
                   .exact = exact,
                   .error = std::abs(found / exact - 1.0),
                   .bar = 0.02});
  };
  for (double b : {0.0, 40.0}) add("semi-implicit-euler", b, 4 * m / (kTick * kTick) - 2 * b / kTick);
  for (double b : {10.0, 40.0}) add(kHeld, b, 2 * b / kTick);
  double unstable = 0;
  for (double k : {1e2, 1e4, 1e6, 1e8, 1e10, 1e12})
    unstable += !bounded("linearly-implicit-euler", k, 0.0, fault);
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
          "largest stable coupling stiffness at a tick of 1 ms: 4 m/h^2 - 2 b/h semi-implicit, 2 b/h held "
          "over "
          "the tick, none implicit",
      .why =
          "the stiffness of a virtual wall is bounded by the coupling's; which scheme bounds it, and where, "
          "must be known beforehand",
      .quick = true,
      .run = run,
      .faults = {{"no-damping", "semi-implicit-euler: largest stable k, b = 40"},
                 {"half-stiffness", "largest stable k"},
                 {"force-of-last-tick", "held over the tick"},
                 {"explicit-for-implicit", "linearly-implicit-euler"}}};
}

}  // namespace palpate::validation
