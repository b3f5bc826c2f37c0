#include "cases.h"
#include "e_faulty_tool.h"
#include "e_oscillator.h"

// Problem: a wall pushes with K times the depth of the tool, and the handle is held at the depth D below its
// surface.
//
// Exact answer: the two springs are in series, k (D - z) = K z, so the tool rests at z = k D/(k + K) and the
// force on the hand is
//     F = k K/(k + K) D.
// A device never renders a stiffness above that of its coupling. Measured: this force, limit 1e-6.

namespace palpate::validation {
namespace {

constexpr double kWall = 1700.0, kDepth = 0.004;  // [N/m], [m]

dynamics::LinearisedContact wall(double stiffness) {
  dynamics::LinearisedContact record;
  record.version = 1;
  record.source = dynamics::LinearisedContact::Source::kFrozen;
  record.J[6 * 5 + 5] = -stiffness;  // Force along z by displacement along z.
  return record;
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  for (const auto& info : tool::tool_integrators()) {
    ToolSpec spec = desktop_tool(info.name);
    spec.coupling.damping_n_s_m = 20.0;  // e^{-b t/2m} = 1e-13 at the end
    const double k = spec.coupling.stiffness_n_m, exact = k * kWall / (k + kWall) * kDepth;
    FaultyTool body(spec, fault);
    const Pose below{Quat::Identity(), Vec3(0, 0, -kDepth)};
    bool ok = true;
    for (int i = 0; ok && i < 300; ++i) ok = body.advance(1e-3, {below, below, {}, {}}, wall(kWall)).ok();
    const double force = ok ? body.wrench_on_hand(below, {}).force.z() : NAN;
    out.push_back({.quantity = info.name + ": force on the hand [N]",
                   .computed = force,
                   .exact = exact,
                   .error = std::abs(force - exact) / exact,
                   .bar = 1e-6});
  }
  return out;
}

}  // namespace

ValidationCase handle_below_wall() {
  return {.name = "handle-below-wall",
          .section = "E",
          .summary = "steady force of a handle held below a linear wall: coupling and wall in series",
          .why = "a device renders the wall in series with the coupling, with stiffness k K/(k + K) exactly",
          .quick = true,
          .run = run,
          .faults = {{"half-contact", "force on the hand"},
                     {"half-stiffness", "force on the hand"},
                     {"wrong-sign", "force on the hand"}}};
}

}  // namespace palpate::validation
