#pragma once
#include <Eigen/Core>

#include "palpate/core/archive.h"

namespace palpate::device {

/// One axis of an arm that holds a device: M x'' + d x' + k x = p(t) - f sgn(x'). The integration has no time
/// discretisation error for a p that is linear over a step. If x is an angle, M is a moment of inertia, and
/// the other parameters correspondingly.
class ArmAxis {
 public:
  /// Coefficients of the equation of motion.
  struct Parameters {
    double mass = 1.0;       ///< M > 0 [kg]
    double damping = 0.0;    ///< d >= 0 [N s/m]
    double stiffness = 0.0;  ///< k >= 0 [N/m]
    double friction = 0.0;   ///< f >= 0, Coulomb friction [N]
  };
  explicit ArmAxis(const Parameters& parameters) : a_(parameters) {}

  /// Sets position and velocity.
  void place(double x, double v) { x_ = x, v_ = v; }
  /// Advances by one step.
  /// @param h  length of the step [s]  @param p0, p1  p at its start and end [N]
  void advance(double h, double p0, double p1);
  double x() const { return x_; }
  double v() const { return v_; }  ///< Exactly 0 during sticking.
  /// Writes the state to an archive, or restores it. The cached step length is included, because steps that
  /// differ from it by rounding use its transition.
  void archive(Archive& a);

 private:
  struct Point {
    double x, v, a;
  };
  Point at(double s, double p, double q) const;
  double zero_of(double Point::*what, double low, double high, double p, double q) const;
  bool stays_to(double& left, double& p, double q, double& sign) const;
  double slide(double left, double p, double q, double sign, bool from_rest);
  void advance_with_friction(double h, double p, double q);

  Parameters a_;
  double x_ = 0.0, v_ = 0.0;
  mutable double kept_length_ = 0.0;          ///< Step length of `kept_` [s].
  mutable Eigen::Matrix<double, 2, 4> kept_;  ///< Cached transition of the usual step.
};

/// Returns the first two rows of exp(A s), A = [0 1 0 0; -k/M -d/M 1/M 0; 0 0 0 1; 0 0 0 0].
Eigen::Matrix<double, 2, 4> arm_transition(const ArmAxis::Parameters& parameters, double s);

}  // namespace palpate::device
