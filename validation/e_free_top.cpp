#include <algorithm>
#include <cmath>

#include "cases.h"
#include "e_faulty_tool.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/dynamics/system.h"
#include "palpate/integrate/integrators.h"

// Problem: a top without torque. A tool without coupling is a top, and so is a free bone or a tool that is a
// block of the State, where its gyroscopic force is a term of the System.
//
// Exact answer (Jacobi's solution; Landau and Lifshitz, Mechanics, 37). Euler's equations, w in the body's
// principal axes, I1 < I2 < I3:
//     I1 w1' = (I2 - I3) w2 w3,   I2 w2' = (I3 - I1) w3 w1,   I3 w3' = (I1 - I2) w1 w2.
// They conserve 2 T = sum I w^2 and L^2 = sum I^2 w^2. If L^2 > 2 T I2 the solution circles around axis 3,
//     w1 = a1 cn(wp t),   w2 = a2 sn(wp t),   w3 = a3 dn(wp t),
//     wp^2 = (I3 - I2) (L^2 - 2 T I1)/(I1 I2 I3),   m = (I2 - I1) (2 T I3 - L^2)/((I3 - I2) (L^2 - 2 T I1)),
// with the period 4 K(m)/wp. L = R I w is constant in the world.
//
// Measured: period, energy and angular momentum. The period is the time between upward zero crossings of w2:
// at the start, and a period later. Between two samples, h apart, w2 is Hermite's cubic with its slopes from
// Euler's equations: the error is h^4 w2''''/384, about 1e-14 of w2 at (wp h) = 1e-3. Limit 1e-8 for one
// period: drifts grow with time, and with a local error of 1e-10, the tool's, backward differences
// (simbody-cpodes) lose 6e-9 per period, so that three periods would exceed the limit.

namespace palpate::validation {
namespace {

const Vec3 kInertia(2e-5, 3.5e-5, 5e-5);  // [kg m^2]
constexpr double kMass = 0.1;             // [kg]
const Vec3 kSpin(3.0, 0.0, 6.0);          // At the start, in the body's axes [rad/s].
const Pose kStart{quaternion_of(Vec3(0.9, -1.1, 0.7)), Vec3::Zero()};

double twice_energy(const Vec3& w) { return w.dot(kInertia.cwiseProduct(w)); }

double period() {
  const double T2 = twice_energy(kSpin), L2 = kInertia.cwiseProduct(kSpin).squaredNorm(), I1 = kInertia.x(),
               I2 = kInertia.y(), I3 = kInertia.z(),
               wp = std::sqrt((I3 - I2) * (L2 - T2 * I1) / (I1 * I2 * I3)),
               m = (I2 - I1) * (T2 * I3 - L2) / ((I3 - I2) * (L2 - T2 * I1));
  return 4.0 * std::comp_ellint_1(std::sqrt(m)) / wp;
}

/// Observed motion of a top: time of the last upward crossing of w2, largest drifts of energy and angular
/// momentum.
struct Watch {
  double crossing = std::nan(""), energy = 0.0, momentum = 0.0;
  int crossings = 0;

  /// Returns the result of a run that did not reach its end.
  static Watch failed() {
    Watch out;
    out.energy = out.momentum = std::nan("");
    return out;
  }
  void start(const Pose& pose, const Vec3& spin) {
    before_ = body(pose, spin);
    time_ = 0.0;
    energy_ = twice_energy(before_);
    momentum_ = pose.rotation * Vec3(kInertia.cwiseProduct(before_));
  }
  void sample(double t, const Pose& pose, const Vec3& spin) {
    const Vec3 w = body(pose, spin);
    energy = worse(energy, std::abs(twice_energy(w) / energy_ - 1.0));
    momentum = worse(momentum,
                     (pose.rotation * Vec3(kInertia.cwiseProduct(w)) - momentum_).norm() / momentum_.norm());
    if (before_.y() < 0.0 && w.y() >= 0.0) {
      crossing = time_ +
                 (t - time_) * zero(before_.y(), w.y(), slope(before_) * (t - time_), slope(w) * (t - time_));
      ++crossings;
    }
    before_ = w;
    time_ = t;
  }

 private:
  /// Returns the larger value, or NaN if either is NaN.
  static double worse(double a, double b) { return b <= a ? a : b; }
  static Vec3 body(const Pose& pose, const Vec3& spin) { return pose.rotation.conjugate() * spin; }
  static double slope(const Vec3& w) { return (kInertia.z() - kInertia.x()) / kInertia.y() * w.z() * w.x(); }
  /// Returns the zero of Hermite's cubic with these values and slopes on [0, 1].
  static double zero(double y0, double y1, double d0, double d1) {
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 60; ++i) {
      const double s = 0.5 * (low + high), r = 1.0 - s;
      const double y =
          r * r * (1.0 + 2.0 * s) * y0 + s * r * r * d0 + s * s * (3.0 - 2.0 * s) * y1 - s * s * r * d1;
      (y < 0.0 ? low : high) = s;
    }
    return 0.5 * (low + high);
  }
  Vec3 before_, momentum_;
  double time_ = 0.0, energy_ = 0.0;
};

constexpr double kTick = 1e-3;
int ticks() { return static_cast<int>(std::ceil(1.1 * period() / kTick)); }

Watch tool_top(const std::string& scheme, const std::string& fault) {
  ToolSpec spec;
  spec.integrator = scheme;
  spec.mass_kg = kMass;
  spec.inertia_kg_m2 = kInertia;
  spec.coupling = {0.0, 0.0, 0.0, 0.0};
  FaultyTool body(spec, fault);
  const Vec3 spin = kStart.rotation * kSpin;
  body.set_state(0.0, kStart, {spin, Vec3::Zero()});
  Watch watch;
  watch.start(kStart, spin);
  for (int i = 1; i <= ticks(); ++i) {
    if (!body.advance(kTick, {kStart, kStart, {}, {}}, {}).ok()) return Watch::failed();
    watch.sample(i * kTick, body.pose(), body.twist().angular);
  }
  return watch;
}

/// Simulates the top as a rigid block. Fault "no-gyroscopic-force": w is constant in the world.
Watch block_top(const std::string& integrator, const std::string& fault) {
  dynamics::State state;
  dynamics::System system;
  const Vec3 spin = kStart.rotation * kSpin;
  const Quat& r = kStart.rotation;
  const int id = state.insert(dynamics::rigid_block("top", 1.0, kSpin.norm()),
                              (VecX(7) << r.w(), r.x(), r.y(), r.z(), 0.0, 0.0, 0.0).finished(),
                              (VecX(6) << spin, 0.0, 0.0, 0.0).finished());
  system.add(dynamics::make_rigid_inertia(id, kMass, kInertia));
  if (fault != "no-gyroscopic-force") system.add(dynamics::make_gyroscopic(id, kInertia, true));
  system.prepare(state.view());
  IntegratorSpec spec;
  spec.name = integrator;
  const auto& entry = find(integrate::stepper_registry(), integrator, "integrator");
  spec.rtol = fault == "tolerance-ignored" ? 1e-4 : std::max(1e-12, entry.tightest_rtol(spec));
  if (fault == "first-order-rule") {
    spec.name = "backward-euler";
    spec.step_s = kTick;
  }
  const auto stepper = integrate::make_stepper(system, state, spec);
  Watch watch;
  watch.start(kStart, spin);
  for (int i = 1; i <= ticks(); ++i) {
    if (!stepper->advance_to(i * kTick).ok()) return Watch::failed();
    const dynamics::RigidMotion m =
        dynamics::motion_of(state.view(), dynamics::rigid_block_of(state.view(), id));
    watch.sample(i * kTick, m.pose, m.twist.angular);
  }
  return watch;
}

void measure(const std::string& name, const Watch& w, std::vector<Measurement>& out) {
  const double exact = period(), found = w.crossings == 1 ? w.crossing : std::nan("");
  out.push_back({.quantity = name + ": period [s]",
                 .computed = found,
                 .exact = exact,
                 .error = std::abs(found / exact - 1.0),
                 .bar = 1e-8});
  out.push_back({.quantity = name + ": drift of energy in a period",
                 .computed = w.energy,
                 .error = w.energy,
                 .bar = 1e-8});
  out.push_back({.quantity = name + ": drift of angular momentum in a period",
                 .computed = w.momentum,
                 .error = w.momentum,
                 .bar = 1e-8});
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  for (const char* scheme : {"simbody-rkmerson", "simbody-cpodes"})
    measure("tool, " + std::string(scheme), tool_top(scheme, fault), out);
  for (const char* integrator : {"cvode-bdf", "ark-dirk-ark548"})
    measure("block of the State, " + std::string(integrator), block_top(integrator, fault), out);
  return out;
}

}  // namespace

ValidationCase free_top() {
  return {.name = "free-top",
          .section = "E",
          .summary = "a top without torque: period, energy and angular momentum, the tool and a rigid block",
          .why =
              "gyroscopic forces are small in the motion of a hand, so no other case detects errors in them "
              "(Jacobi's solution of Euler's equations)",
          .quick = true,
          .run = run,
          .faults = {{"first-two-axes-swapped", "tool, "},
                     {"no-gyroscopic-force", "State, cvode-bdf: period"},
                     {"tolerance-ignored", "State, cvode-bdf: drift of energy"},
                     {"first-order-rule", "State, ark-dirk-ark548: "}}};
}

}  // namespace palpate::validation
