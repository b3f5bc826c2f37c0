#include "condensation.h"

#include "core/finite.h"

namespace palpate::loop {
namespace {

// Wrench of the contact on the tool after a time H, with the bodies advanced by one linearly implicit Euler
// step from (x0, u0), while the tool is displaced by dx and its twist changes by dv. Indices: n all nodes, f
// free, t tool; c = -df/d(tool), -dF/d(node) from ContactForce::linearise; M, D, K include the contact.
// Driven nodes move to x(t0 + H), v(t0 + H), carried nodes with their bone (rows and columns are reduced to
// the bone by System). s and w are the prescribed displacements and velocity changes,
//     s = H u0 on free directions,  x(t0 + H) - x0 on driven ones,
//     w = 0    on free directions,  v(t0 + H) - u0 on driven ones.
// With u1 = u0 + w + du, du = 0 on driven directions, the nodes end at x0 + s + H du, and the force there is,
// to first order,
//     f1 = f_n - K_nn (s + H du) - D_nn (w + du) - K_nt dx - B_nt dv.
// M (u1 - u0) = H f1 on free directions is
//     A du = H (f_n - K_nn s - D_nn w) - M w - H (K_nt dx + B_nt dv),      A = M + H D + H^2 K,
// and the wrench on the tool, linearised about the same state, is
//     F = F_t - K_tt dx - B_tt dv - K_tn (s + H du) - B_tn (w + du)
//       = [F_t - K_tn s - B_tn w - C g] + J dx + B dv,
//     C = H K_tn + B_tn,  A g = H (f_n - K_nn s - D_nn w) - M w,
//     J = -K_tt + H C A^-1 K_nt,  B = -B_tt + H C A^-1 B_nt,
// the Schur complement of the step matrix for the tool. One part of K_tt is geometric and depends on the
// contact force, not on its stiffness: the rotation of its lever arms. It is computed from the forces after
// the step, at x0 + s + H g, u0 + w + g. To first order this makes no difference, but it does if the forces
// are far from balance: an overlap that arose undetected may press with 1e4 N now and with 0.1 N after the
// step, and a tool that rotates under the former would spin up without bound.
//
// H -> 0 gives `frozen`, H -> infinity the quasi-static response K_tt - K_tn K^-1 K_nt. (Forces that depend
// on time alone are evaluated at t0.)
struct Answer {
  Vec6 wrench;  ///< [F_t - K_tn s - B_tn w - C g]
  Mat6 J, B;
};

/// Computes the response after a time H. Returns false if the step matrix has no factor.
bool answer_after(const CoupledTool& tool, StepFactor& factor, double H, const contact::FrameLinearisation& c,
                  Answer& out) {
  dynamics::System& system = tool.system;
  const dynamics::State& state = tool.state;
  dynamics::LinearSolver* solver = factor.of(system, state.view(), H);
  if (!solver) return false;
  VecX s, w;
  known_motion(system, state, H, s, w);
  const Eigen::Index n = c.K_body.rows();
  MatX rhs = MatX::Zero(state.layout().u_size, 13);
  rhs.topLeftCorner(n, 6) = c.K_body;
  rhs.block(0, 6, n, 6) = c.B_body;
  rhs.col(12) = right_hand_side(system, state, H, s, w, rate_by_other_tools(tool));
  VecX column;
  for (Eigen::Index i = 0; i < 12; ++i) {
    column = rhs.col(i);
    system.reduce(state.view(), column);
    rhs.col(i) = column;
  }
  MatX solved(rhs.rows(), rhs.cols());
  if (solver->solve(rhs, solved) != dynamics::SolveStatus::kOk || !all_finite(solved)) return false;
  for (Eigen::Index i = 0; i < solved.cols(); ++i) {
    column = solved.col(i);
    system.expand(state.view(), column);
    solved.col(i) = column;
  }
  const MatX C = H * c.K_frame + c.B_frame;
  out.J = -c.K + H * C * solved.topLeftCorner(n, 6);
  out.B = -c.B + H * C * solved.block(0, 6, n, 6);
  const VecX g = solved.col(12);
  out.wrench << c.wrench.moment, c.wrench.force;
  out.wrench -= c.K_frame * s.head(n) + c.B_frame * w.head(n) + C * g.head(n);

  VecX q = moved(state, s + H * g), u = state.u() + w + g;
  system.impose(state.layout(), state.time() + H, q.data(), u.data());
  contact::FrameLinearisation after;
  tool.contact.linearise(state.view(state.time(), q.data(), u.data()), tool.frame, after,
                         contact::Partners::kNodes);
  out.J.topLeftCorner<3, 3>() += after.geometric - c.geometric;
  return true;
}

}  // namespace

// The wrench on the tool over the period has two parts. While the tool continues with its velocity v0, the
// wrench is linear in time, through the results of one implicit step after one tick and after the period; J
// and B of the period give the response to any deviation from that motion. After a time s (tick or period)
// the first part is w(s) + s J(s) v0:
//     line(s) = W0 + s S,
//     F = line + J (dx - s v0) + B (v - v0) = W0 + s (S - J v0) + J dx + B (v - v0).
// A contact whose nodes respond within a tick is stiffer over a tick than over the period, which matters most
// along the motion of the tool: with J of the period for all of dx, the error did not decrease between
// periods of 5 and 2.5 ms. A stiff contact that the last period has left out of balance is relaxed within the
// first tick, as in the implicit step of the bodies; a line that began at the present wrench would press with
// it for half the period. Without stiffness, the line begins at the present wrench to O(tick^2).
bool condense(const CoupledTool& tool, StepFactor& factor, double period, double tick,
              const contact::FrameLinearisation& c, dynamics::LinearisedContact& record) {
  Answer last, first;
  if (!answer_after(tool, factor, period, c, last)) return false;
  Vec6 F0 = last.wrench, F1 = Vec6::Zero();
  if (tick < period * (1.0 - 1e-9)) {
    if (!answer_after(tool, factor, tick, c, first)) return false;
    const Vec6 v0 = stacked(tool.motion.twist);
    const Vec6 after_tick = first.wrench + tick * (first.J * v0),
               after_period = last.wrench + period * (last.J * v0);
    const Vec6 slope = (after_period - after_tick) / (period - tick);
    F0 = after_tick - tick * slope;
    F1 = slope - last.J * v0;
  }
  using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  Eigen::Map<Vec6>(record.F0.data()) = F0;
  Eigen::Map<Vec6>(record.F1.data()) = F1;
  Eigen::Map<RowMajor6>(record.J.data()) = last.J;
  Eigen::Map<RowMajor6>(record.B.data()) = last.B;
  record.source = dynamics::LinearisedContact::Source::kCondensed;
  return true;
}

}  // namespace palpate::loop
