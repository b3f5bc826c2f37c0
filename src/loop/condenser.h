#pragma once
#include <memory>

#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/step_assembly.h"
#include "palpate/linear/step_response.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

// The contact's wrench on the tool after a time H, with the bodies moved by one linearly implicit Euler step
// from (x0, u0), while the tool is displaced by dx and its twist changed by dv.  Indices: n all nodes, f
// free, t tool; c = -df/d(tool), -dF/d(node) as ContactForce::linearise gives them; M, D, K include the
// contact.  Driven nodes go to x(t0 + H), v(t0 + H), carried ones with their bone (rows and columns reduced
// onto it by System): s and w are the displacements and velocity changes that are known beforehand,
//     s = H u0 on free directions,  x(t0 + H) - x0 on driven ones,
//     w = 0    on free directions,  v(t0 + H) - u0 on driven ones.
// With u1 = u0 + w + du, du = 0 on driven directions, nodes end at x0 + s + H du, and the force there is, to
// first order,
//     f1 = f_n - K_nn (s + H du) - D_nn (w + du) - K_nt dx - B_nt dv.
// M (u1 - u0) = H f1 on free directions is
//     A du = H (f_n - K_nn s - D_nn w) - M w - H (K_nt dx + B_nt dv),      A = M + H D + H^2 K,
// and the tool feels, linearised about the same state,
//     F = F_t - K_tt dx - B_tt dv - K_tn (s + H du) - B_tn (w + du)
//       = [F_t - K_tn s - B_tn w - C g] + J dx + B dv,
//     C = H K_tn + B_tn,  A g = H (f_n - K_nn s - D_nn w) - M w,
//     J = -K_tt + H C A^-1 K_nt,  B = -B_tt + H C A^-1 B_nt,
// which is the Schur complement of the step matrix onto the tool.  One part of K_tt belongs to the contact's
// force, not to its stiffness: the arms that rotate under it.  It is taken from the forces after the step, at
// x0 + s + H g, u0 + w + g; to first order that is equal.  It is not where the forces are out of balance: a
// depth that came about unseen may press with 1e4 N now and with 0.1 N after the step, and a tool that
// rotated under the first would spin up without end.
//
// H -> 0 gives `frozen`, H -> infinity the quasi-static answer K_tt - K_tn K^-1 K_nt.  (Forces that depend on
// time alone are taken at t0.)

/// That wrench, linear about the tool at rest where it is.
struct CondensedAnswer {
  Vec6 wrench;  ///< [F_t - K_tn s - B_tn w - C g]
  Mat6 J, B;
};

/// What condensations took so far, and how good they were.
struct CondenserCounters {
  long exchanges = 0;
  long factored = 0;           ///< of them, those by factorisations
  long readings = 0;           ///< of a step matrix, by the others
  double seconds = 0.0;        ///< wall time of all of them, checks left out
  double largest_error = 0.0;  ///< relative, as the iteration estimates it
  /// Exchanges that were checked against a factorisation, and the largest differences from it, relative, in
  /// the norm of Condenser: of the wrench on a tool that goes on as it moves, after the period or a tick; of
  /// J and B of the period, B on the scale of B and period J.
  long checked = 0;
  double wrench_difference = 0.0, stiffness_difference = 0.0, damping_difference = 0.0;
};

/// Condenses the bodies' step matrix onto the tool, by conjugate gradients to a wanted error, or by a
/// factorisation: where the error wanted is 0, where the matrix cannot be had in mixed precision, or where it
/// is not positive definite.
class Condenser {
 public:
  /// @param error  of wrench, J and B, relative to their norm with rotations measured at the contact's lever;
  ///   B on the scale of B and period J, wrenches on that of the wrench before and after
  /// @param check  factorise besides, and count the differences
  Condenser(double error, bool check, int threads)
      : error_(error), check_(check), of_period_(threads), of_tick_(threads) {}

  /// The answers after `period` and after `tick`; false where the step matrix has no factor.
  bool answer(World& world, double period, double tick, const contact::FrameLinearisation& contact,
              CondensedAnswer& after_period, CondensedAnswer& after_tick);
  const CondenserCounters& counters() const { return counters_; }

 private:
  struct Columns;
  bool solve(World& world, double period, double tick, const contact::FrameLinearisation& contact,
             CondensedAnswer& after_period, CondensedAnswer& after_tick);
  void check(World& world, double period, double tick, const contact::FrameLinearisation& contact,
             const CondensedAnswer& after_period, const CondensedAnswer& after_tick);
  bool iterate(World& world, double period, double tick, const contact::FrameLinearisation& contact,
               CondensedAnswer& after_period, CondensedAnswer& after_tick);
  bool iterate(linear::StepResponse& response, World& world, double H,
               const contact::FrameLinearisation& contact, CondensedAnswer& out);
  bool solve(linear::StepResponse& response, double H, const Columns& columns, const VecX& right,
             const contact::FrameLinearisation& contact, CondensedAnswer& out, VecX& g);
  bool factor(World& world, double H, const contact::FrameLinearisation& contact, CondensedAnswer& out);
  dynamics::LinearSolver* factored(bool symmetric);

  double error_;
  bool check_;
  CondenserCounters counters_;
  // by conjugate gradients
  std::unique_ptr<dynamics::StepAssembly> assembly_;
  linear::StepResponse of_period_, of_tick_;
  MatX rhs_;
  // by factorisations
  dynamics::BorderedMatrix matrix_;
  std::unique_ptr<dynamics::LinearSolver> solver_, lu_;
};

}  // namespace palpate::loop
