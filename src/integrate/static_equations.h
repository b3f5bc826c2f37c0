#pragma once
#include <limits>

#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::integrate {

/// Positions and forces below it have lost digits to underflow.
inline constexpr double kSmallestLength =
    std::numeric_limits<double>::min() / std::numeric_limits<double>::epsilon();

/// Equations of a quasi-static equilibrium between two times t0 and t1, and the units in which their
/// displacements and residuals are measured:
///
///     G(x) = f(q, 0, t) - (1 - s) f(q0, 0, t0) - sigma M x = 0,   q = q_k moved by x,   t = t0 + s (t1 -
///     t0),
///
/// with the positions q0 at t0 and the last accepted positions q_k.  Velocities are zero.
class StaticEquations {
 public:
  /// @param counters  counts and times evaluations of forces; must outlive the equations, as system and state
  StaticEquations(dynamics::System& system, dynamics::State& state, dynamics::StepperCounters& counters)
      : system_(system), state_(state), counters_(counters) {}

  /// Begins at the State's time and positions: computes the unbalanced force f(q0, 0, t0), the units, and the
  /// matrix at q0.  @return whether the force is finite
  bool begin(double t1);

  double load = 1.0;   ///< s in (0, 1]
  double sigma = 0.0;  ///< factor of proximal steps [1/s^2]; 0: none

  /// Computes the residual at the displacement x, for a given sigma.  @return whether it is finite
  bool residual(const double* x, double sigma_of_it, VecX& g);
  /// Assembles the matrix at the displacement x.
  void assemble_at(const double* x);
  /// Assembles the matrix at the positions of the last residual or assemble_at().
  void assemble();
  /// Makes the displacement x the State's positions, and those that later displacements start from.
  void accept(const double* x);

  /// Matrix that assemble() computes: the derivative of -G.
  dynamics::BorderedMatrix& matrix() { return A_; }
  /// Reciprocals of the units, by direction of u [1/m, 1/rad; 1/N, 1/(N m)].
  const VecX& displacement_scale() const { return displacement_scale_; }
  const VecX& force_scale() const { return force_scale_; }
  /// Returns the largest entry of a residual, in units of force.
  double size_of(const VecX& g) const { return g.cwiseProduct(force_scale_).cwiseAbs().maxCoeff(); }
  /// Returns the rounding of the residual, in units of force, from the current matrix.
  double rounding();
  /// Returns the initial sigma of proximal steps [1/s^2]: the largest stiffness of a node over the largest
  /// mass of one, and for directions of other blocks the largest ratio of one direction.
  double stiffness_over_mass();

 private:
  double time() const { return t0_ + load * (t1_ - t0_); }
  void place(const double* x, VecX& q);
  bool force(double t, const VecX& q, VecX& f);
  void measure();
  void add_forces(double t, VecX& largest);
  VecX diagonal() const;

  dynamics::System& system_;
  dynamics::State& state_;
  dynamics::StepperCounters& counters_;
  dynamics::BorderedMatrix A_, absolute_;
  VecX base_q_, q_, rate_, velocity_, unbalanced_, inertia_, coordinate_, summands_;
  VecX displacement_scale_, force_scale_;
  double t0_ = 0.0, t1_ = 0.0, far_ = 0.0, force_ = 0.0;
};

}  // namespace palpate::integrate
