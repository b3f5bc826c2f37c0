#pragma once
#include <cmath>
#include <memory>
#include <string>

#include "palpate/contact/contact_force.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/system.h"
#include "palpate/integrate/integrators.h"

/// A flat punch that meets a plane, the problem of b_punch_bounce.cpp.
namespace palpate::validation::punch {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kMass = 0.2, kArea = 1e-4, kStiffness = 2e7;  // K = 2000 N/m, w = 100 rad/s
inline constexpr double kSpeed = 0.5, kHeight = 2e-3;
inline const double kOmega = std::sqrt(kStiffness * kArea / kMass);

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

  /// @param fault  injected fault; empty: none
  Bounce(double height, const Law& asked, IntegratorSpec integrator, const std::string& fault);

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

}  // namespace palpate::validation::punch
