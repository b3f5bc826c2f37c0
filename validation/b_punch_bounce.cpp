#include <cmath>
#include <functional>

#include "b_bodies.h"
#include "cases.h"
#include "faults.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/system.h"
#include "palpate/integrate/integrators.h"

// Problem: a flat punch with area A and mass m meets a plane at speed v0, without gravity. The contact is one
// spring K = k A with a damper c = d A:
//     m x'' + c x' + K x = 0,   x(0) = 0, x'(0) = v0 (depth),   w = sqrt(K/m), zeta = c/(2 sqrt(K m)).
//
// Exact answer:
// - No damping: x = v0/w sin(w t); contact lasts pi/w, and the speed is restored fully.
// - Kelvin-Voigt without adhesion, zeta < 1, s = sqrt(1 - zeta^2), b = zeta/s:
//       x = v0/(w s) exp(-zeta w t) sin(w s t).
//   The contact force K x + c x' is zero when tan(w s t) = -2 zeta s/(1 - 2 zeta^2), first at
//       w s t1 = pi - atan2(2 zeta s, 1 - 2 zeta^2),
//   with depth still > 0; from there it would pull, so the punch separates with x'(t1):
//       e = -x'(t1)/v0 = exp(-b (pi - atan2(2 zeta s, 1 - 2 zeta^2))).
//   zeta = 1 is the limit: w t1 = 2, e = exp(-2).  zeta = 0.1, 0.3, 0.5 give e = 0.744079, 0.450975,
//   0.298436.
// - Hunt-Crossley (1975), a = 3 c/2: the equation m v v'(x) = -K x (1 + a v) separates into
//       m v dv/(1 + a v) = -K x dx,
//   and x vanishes at both ends, so the integral of v/(1 + a v) from -e v0 to v0 is zero:
//       G(a v0) = G(-e a v0),   G(u) = u - ln(1 + u).
//   It holds for any shape, as only p(x) (1 + a v) was used.
//
// Measured: duration of contact, restitution and depth at the release, by cvode-bdf with rtol 1e-8. Limit
// 1e-6 where the motion is smooth but for kinks, 1e-5 with damping. The integrator is not restarted at the
// kink at touch, the jump of a damper at touch, or the kink at the end of the force: it runs from free flight
// to free flight. Touch and release are evaluated from its dense output, step by step. Each quantity is
// measured with both ways in which the library handles these points: error control alone, and location of the
// kinks as roots. Fixed-step methods must show their order in contact (+/- 0.1), and order 1 through a damped
// touch, where the force jumps within a step.

namespace palpate::validation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kMass = 0.2, kArea = 1e-4, kStiffness = 2e7;  // K = 2000 N/m, w = 100 rad/s
constexpr double kSpeed = 0.5, kHeight = 2e-3;
const double kOmega = std::sqrt(kStiffness * kArea / kMass);

/// Fault "adhesive": Kelvin-Voigt pressure without the cut-off of its tensile part.
class Adhesive final : public DecoratedTerm {
 public:
  Adhesive(std::shared_ptr<dynamics::ForceTerm> term, double damping)
      : DecoratedTerm(std::move(term)), damping_(damping) {}
  void add_force(const dynamics::StateView& state, VecX& f) override {
    term().add_force(state, f);
    if (state.q[2] < 0.0) f[2] += std::min(0.0, -kArea * (kStiffness * state.q[2] + damping_ * state.u[2]));
  }

 private:
  double damping_;
};

/// Fault "drag": slight damping out of contact.
class Drag final : public DecoratedTerm {
 public:
  using DecoratedTerm::DecoratedTerm;
  void add_force(const dynamics::StateView& state, VecX& f) override {
    term().add_force(state, f);
    f[2] -= 1e-6 * kMass * state.u[2];
  }
};

/// Punch above (or in) the plane, simulated with the library's contact term, system and stepper.
struct Bounce {
  dynamics::State state;
  dynamics::System system;
  std::shared_ptr<contact::ContactForce> term = std::make_shared<contact::ContactForce>();
  std::unique_ptr<dynamics::Stepper> stepper;

  struct Law {
    double zeta = 0.0;
    bool hunt_crossley = false;  ///< a v0 = 3 zeta
    bool stepped = false;        ///< The end of the punch has 16 steps from 0 to 3 mm instead of a flat face.
  };

  Bounce(double height, const Law& asked, IntegratorSpec integrator, const std::string& fault) {
    dynamics::BlockSpec node;
    node.name = "punch";
    node.q_size = node.u_size = 3;
    node.q_scale = kSpeed / kOmega;
    node.u_scale = kSpeed;
    const int id = state.insert(node, Vec3(0.1, -0.2, height), Vec3(0, 0, -kSpeed));
    term->add_frame(contact::fixed_frame());
    ContactSpec law;
    law.stiffness_pa_m = kStiffness;
    law.damping_pa_s_m = 2.0 * asked.zeta * std::sqrt(kStiffness * kArea * kMass) / kArea;
    if (asked.hunt_crossley != (fault == "other-law")) {
      law.law = "hunt_crossley";
      law.hunt_crossley_s_m = 2.0 * asked.zeta / kSpeed;
    }
    auto source = make_punch_source(0, kArea, 4, 0);
    if (asked.stepped)
      source = spoiled(std::move(source), [](auto& samples) {
        double up = 0.0;
        for (auto& s : samples) {
          s.a.offset.z() += up;
          s.gap += up;
          up += 2e-4;
        }
      });
    if (fault == "half-area")
      source = spoiled(std::move(source), [](auto& samples) {
        for (auto& s : samples) s.area *= 0.5;
      });
    term->add_pair(std::move(source), law);
    if (fault == "adhesive")
      system.add(std::make_shared<Adhesive>(term, law.damping_pa_s_m));
    else if (fault == "drag")
      system.add(std::make_shared<Drag>(term));
    else
      system.add(std::static_pointer_cast<dynamics::ForceTerm>(term));
    if (fault == "half-damping") system.add(friction_defect(term, 0.5));
    system.add(std::make_shared<PointMass>(id, kMass));
    term->refresh(state.view());
    system.prepare(state.view());
    if (fault == "tolerance-ignored") integrator.rtol = 1e-3;
    if (fault == "first-order-rule" && integrator.name == "implicit-midpoint")
      integrator.name = "backward-euler";
    stepper = integrate::make_stepper(system, state, integrator);
  }

  double height() const { return state.q()[2]; }
  double velocity() const { return state.u()[2]; }
  double force_at(const VecX& q, const VecX& u) {
    VecX f = VecX::Zero(3);
    term->add_force(state.view(0.0, q.data(), u.data()), f);
    return f[2];
  }

  dynamics::StepResult advance(double t) {
    const auto result = stepper->advance_to(t);
    if (!result.ok()) fail("punch bounce: {}", result.message);
    return result;
  }
};

/// Times at which the punch touched and at which the force on it ended, from the dense output of each step.
struct Contact final : dynamics::StepFollower {
  explicit Contact(Bounce& b) : bounce(b) { PALPATE_CHECK(b.stepper->follow(this), "not followed"); }
  ~Contact() override { bounce.stepper->follow(nullptr); }

  void stepped(const dynamics::Stepper& stepper, double t0, double t1) override {
    if (std::isnan(touch)) {
      touch = root(stepper, t0, t1, [&] { return q_[2]; });
      if (!std::isnan(touch)) t0 = touch;
    }
    if (std::isnan(touch) || !std::isnan(release)) return;
    // Starts slightly inside the step: at touch the force is zero, which is not its end.
    t0 += 1e-3 * (t1 - t0);
    release = root(stepper, t0, t1, [&] { return bounce.force_at(q_, u_); });
    if (!std::isnan(release)) depth_left = -q_[2];
  }

  Bounce& bounce;
  double touch = std::nan(""), release = std::nan(""), depth_left = std::nan("");

 private:
  /// Returns the time at which a function falls to zero within the step; NaN if it does not.
  template <class Value>
  double root(const dynamics::Stepper& stepper, double t0, double t1, const Value& value) {
    const auto positive = [&](double t) {
      PALPATE_CHECK(stepper.dense_output(t, q_, u_), "no dense output at t = {}", t);
      return value() > 0.0;
    };
    if (!positive(t0) || positive(t1)) return std::nan("");
    double low = t0, high = t1;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (positive(middle) ? low : high) = middle;
    }
    positive(high);
    return high;
  }
  VecX q_{3}, u_{3};
};

IntegratorSpec cvode(const std::string& events) {
  IntegratorSpec spec;
  spec.name = "cvode-bdf";
  spec.rtol = 1e-8;
  spec.events = events;
  return spec;
}

IntegratorSpec fixed_step(const std::string& name, double step) {
  IntegratorSpec spec;
  spec.name = name;
  spec.fixed_step = true;
  spec.step_s = step;
  spec.rtol = spec.newton_rtol = 1e-11;
  return spec;
}

Measurement against(const std::string& quantity, double computed, double exact, double bar) {
  Measurement m;
  m.quantity = quantity;
  m.computed = computed;
  m.exact = exact;
  m.error = std::abs(computed - exact) / std::abs(exact);
  m.bar = bar;
  return m;
}

struct Outcome {
  double duration;     ///< From touch to the end of the force [s].
  double restitution;  ///< Speed after over speed before.
  double depth_left;   ///< Depth when the force ended [m].
};

Outcome bounce(const Bounce::Law& law, const std::string& events, const std::string& fault) {
  Bounce b(kHeight, law, cvode(events), fault);
  const Contact contact(b);
  b.advance(kHeight / kSpeed + 2.0 * kPi / kOmega);  // Well after separation.
  return {contact.release - contact.touch, b.velocity() / kSpeed, contact.depth_left};
}

constexpr const char* kWays[] = {"error-control", "root-finding"};

struct Method {
  const char* name;
  int order;
};
constexpr Method kMethods[] = {{"linearly-implicit-euler", 1},
                               {"backward-euler", 1},
                               {"symplectic-euler", 1},
                               {"implicit-midpoint", 2},
                               {"bdf2", 2},
                               {"newmark", 2},
                               {"generalized-alpha", 2},
                               {"ark-dirk-esdirk324", 3},
                               {"rk4", 4}};

/// Measures the order of a fixed-step method in smooth contact: depth and speed after a quarter period
/// against the harmonic motion.
Measurement order_in_contact(const Method& method, const std::string& fault) {
  std::vector<double> h, error;
  const double end = 0.5 * kPi / kOmega;
  for (const int part : {1, 2, 4, 8}) {
    const int steps = (method.order > 2 ? 10 : 100) * part;
    Bounce b(0.0, {}, fixed_step(method.name, end / steps), fault);
    b.state.q()[2] = -1e-12;  // In contact from the start.
    b.advance(end);
    h.push_back(end / steps);
    // Exact: x = v0/w, x' = 0.
    error.push_back(std::hypot(kOmega * b.height() + kSpeed, b.velocity()) / kSpeed);
  }
  Measurement m = against(fmt::format("{} in contact, {} steps per quarter period: depth w/v0 and speed/v0",
                                      method.name, method.order > 2 ? 80 : 800),
                          1.0 + error.back(), 1.0, 5e-3);
  m.order = validation::fitted_order(h, error);
  m.order_low = method.order - 0.1;
  m.order_high = method.order + 0.1;
  m.refinement = {"step [s]", h, error};
  return m;
}

/// Measures free flight, where x' is constant: every consistent method is exact, for any step.
Measurement free_flight(const Method& method, const std::string& fault) {
  Bounce b(1.0, {}, fixed_step(method.name, 1e-3), fault);
  b.advance(0.1);
  return against(fmt::format("{} in free flight, height after 100 steps [m]", method.name), b.height(),
                 1.0 - 0.1 * kSpeed, 1e-12);
}

/// Measures the order of a fixed-step method through a damped bounce: the force jumps at touch, within a
/// step, so every method has order 1. The position of the jump within the step varies: RMS over starting
/// heights.
Measurement order_through_touch(double zeta, double e, const std::string& fault) {
  constexpr int kHeights = 32;
  std::vector<double> h, error;
  double last = 0.0;
  for (const int steps : {200, 400, 800, 1600}) {
    const double step = kPi / kOmega / steps;
    double squares = 0.0;
    for (int i = 0; i < kHeights; ++i) {
      Bounce b(step * kSpeed * (10.0 + (i + 0.5) / kHeights), {.zeta = zeta},
               fixed_step("linearly-implicit-euler", step), fault);
      b.advance(step * (steps + 20));  // Touches after 10 to 11 steps, and has separated by the end.
      last = b.velocity() / kSpeed;
      squares += std::pow(last / e - 1.0, 2) / kHeights;
    }
    h.push_back(step);
    error.push_back(std::sqrt(squares));
  }
  Measurement m = against(
      fmt::format(
          "restitution by linearly-implicit-euler through touch and release, zeta = {}, RMS over 32 heights",
          zeta),
      last, e, 1e-2);
  m.error = error.back();
  m.order = validation::fitted_order(h, error);
  m.order_low = 0.9;
  m.order_high = 1.1;
  return m;
}

std::vector<Measurement> run_undamped(const std::string& fault) {
  std::vector<Measurement> out;
  for (const char* way : kWays) {
    const Outcome o = bounce({}, way, fault);
    const std::string name = fmt::format("cvode-bdf, rtol 1e-8, {}: ", way);
    out.push_back(against(name + "contact duration [s]", o.duration, kPi / kOmega, 1e-6));
    out.push_back(against(name + "speed after over speed before", o.restitution, 1.0, 1e-6));
    out.push_back(
        against(name + "energy after over energy before", o.restitution * o.restitution, 1.0, 1e-6));
  }
  for (const Method& method : kMethods) out.push_back(order_in_contact(method, fault));
  for (const Method& method : kMethods) out.push_back(free_flight(method, fault));
  return out;
}

std::vector<Measurement> run_damped(const std::string& fault) {
  std::vector<Measurement> out;
  for (const double zeta : {0.1, 0.3, 0.5, 1.0}) {
    const double s = std::sqrt(1.0 - zeta * zeta);
    const double angle = kPi - std::atan2(2.0 * zeta * s, 1.0 - 2.0 * zeta * zeta);
    const double e = zeta < 1.0 ? std::exp(-zeta / s * angle) : std::exp(-2.0);
    const double duration = zeta < 1.0 ? angle / (kOmega * s) : 2.0 / kOmega;
    for (const char* way : kWays) {
      const Outcome o = bounce({.zeta = zeta}, way, fault);
      const std::string name = fmt::format("{}, zeta = {}: ", way, zeta);
      out.push_back(against(name + "coefficient of restitution", o.restitution, e, 1e-5));
      out.push_back(against(name + "contact duration [s]", o.duration, duration, 1e-5));
      Measurement left;
      left.quantity = name + "depth left when the force ends [m] (must be > 0)";
      left.computed = o.depth_left;
      left.exact = zeta < 1.0 ? kSpeed / (kOmega * s) * std::exp(-zeta / s * angle) * std::sin(angle)
                              : kSpeed / kOmega * 2.0 * std::exp(-2.0);
      left.error = o.depth_left > 0.0 ? std::abs(left.computed / left.exact - 1.0) : 1.0;
      left.bar = 1e-5;
      out.push_back(left);
    }
    if (zeta == 0.3) out.push_back(order_through_touch(zeta, e, fault));
  }
  return out;
}

/// Returns the root e in (0, 1) of G(u) = G(-e u) by bisection: G(-e u) grows with e from 0.
double hunt_crossley_restitution(double u) {
  const auto G = [](double x) { return x - std::log1p(x); };
  double low = 0.0, high = std::min(1.0, 1.0 / u);
  for (int i = 0; i < 200; ++i) {
    const double e = 0.5 * (low + high);
    (e * u < 1.0 && G(-e * u) < G(u) ? low : high) = e;
  }
  return low;
}

std::vector<Measurement> run_hunt_crossley(const std::string& fault) {
  std::vector<Measurement> out;
  for (const bool stepped : {false, true})
    for (const double u : {0.3, 1.0})  // a v0 = 3/2 c v0
      for (const char* way : kWays) {
        const Bounce::Law law{.zeta = u / 3.0, .hunt_crossley = true, .stepped = stepped};
        out.push_back(against(fmt::format("{} punch, {}, 3/2 c v0 = {}: coefficient of restitution",
                                          stepped ? "stepped" : "flat", way, u),
                              bounce(law, way, fault).restitution, hunt_crossley_restitution(u), 1e-5));
      }
  return out;
}

}  // namespace

ValidationCase punch_bounce() {
  return {"punch-bounce",
          "B",
          "Undamped bounce of a flat punch on a plane: duration, speed, energy; fixed-step order in contact",
          "A flat contact is one linear spring k A: it must return the energy that it stores, with any "
          "integrator.",
          false,
          true,
          run_undamped,
          {{"half-area", "contact duration"},
           {"tolerance-ignored", "contact duration"},
           {"first-order-rule", "implicit-midpoint in contact"},
           {"drag", "in free flight"}}};
}

ValidationCase punch_bounce_damped() {
  return {
      "punch-bounce-damped",
      "B",
      "Bounce of a flat punch with Kelvin-Voigt damping and no adhesion, zeta = 0.1, 0.3, 0.5, 1",
      "The pressure is cut off at zero, so the punch separates before the depth vanishes: the closed form "
      "includes the cut-off.",
      false,
      true,
      run_damped,
      {{"half-damping", "coefficient of restitution"},
       {"other-law", "contact duration"},
       {"adhesive", "coefficient of restitution"}}};
}

ValidationCase punch_bounce_hunt_crossley() {
  return {
      "punch-bounce-hunt-crossley",
      "B",
      "Bounce with Hunt-Crossley damping against its implicit closed form, 3/2 c v0 = 0.3 and 1, two shapes",
      "The continuous damping law: its loss depends on speed, unlike that of a linear damper.",
      false,
      true,
      run_hunt_crossley,
      {{"other-law", "coefficient of restitution"}, {"half-damping", "coefficient of restitution"}}};
}

}  // namespace palpate::validation
