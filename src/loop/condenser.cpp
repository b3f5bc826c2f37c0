#include "condenser.h"

#include <cmath>

#include "palpate/core/counters.h"
#include "palpate/core/finite.h"
#include "palpate/linear/solvers.h"
#include "tool_side.h"

namespace palpate::loop {

using dynamics::SolveStatus;
using linear::StepResponse;

namespace {

/// Directions of contact's columns that are smaller than the largest by this are left out.
constexpr double kNegligible = 1e-5;
/// Iterations after which a factorisation is the safer bet.
constexpr int kMostIterations = 60;
/// Contact so much stiffer than the body's nodes is factorised.
constexpr double kStiffContact = 100.0;
/// Rounding of S, relative: J is what large terms leave where contact is far stiffer than the body.
constexpr double kRounding = 1e-5;
/// Damping that differs from a multiple of the stiffness by more is not proportional.
constexpr double kProportional = 0.05;

/// q0 moved by a displacement along u-directions.
VecX moved(const World& world, const VecX& displacement) {
  VecX rate(world.state.q().size());
  dynamics::q_dot(world.state.layout(), world.state.q().data(), displacement.data(), rate.data());
  VecX q = world.state.q() + rate;
  dynamics::project(world.state.layout(), q.data());
  return q;
}

/// s and w of the derivation.
void known_motion(World& world, double H, VecX& s, VecX& w) {
  const VecX q0 = world.state.q(), u0 = world.state.u();
  VecX q = moved(world, H * u0), u = u0;
  s = H * u0;
  w = VecX::Zero(u0.size());
  world.system.impose(world.state.layout(), world.state.time() + H, q.data(), u.data());
  for (int dof : world.system.driven_dofs()) {
    s[dof] = q[dof] - q0[dof];
    w[dof] = u[dof] - u0[dof];
  }
}

VecX right_hand_side(World& world, double H, const VecX& s, const VecX& w) {
  const dynamics::StateView view = world.state.view();
  VecX f, inertia, stiff = VecX::Zero(s.size());
  world.system.force(view, f);
  for (const auto& term : world.system.terms()) {
    if (!term->traits().has_tangent) continue;
    term->apply_tangent(view, 1.0, 0.0, s, stiff);
    term->apply_tangent(view, 0.0, 1.0, w, stiff);
  }
  world.system.apply_mass(view, w, inertia);
  VecX r = H * (f - stiff) - inertia;
  world.system.reduce(view, r);
  stiff.setZero();
  world.system.apply_carried_stiffness(view, s, stiff);
  return r - H * stiff;
}

/// The part of J that is the arms' which rotate under the contact's force: after the step.
Mat3 rotating_arms(World& world, double H, const VecX& s, const VecX& w, const VecX& g,
                   contact::FrameLinearisation& after) {
  VecX q = moved(world, s + H * g), u = world.state.u() + w + g;
  world.system.impose(world.state.layout(), world.state.time() + H, q.data(), u.data());
  world.contact->linearise(world.state.view(world.state.time(), q.data(), u.data()),
                           ToolSide::of(world).frame_index, after, contact::Partners::kNodes);
  return after.geometric;
}

Vec6 wrench_of(const contact::FrameLinearisation& c) {
  Vec6 out;
  out << c.wrench.moment, c.wrench.force;
  return out;
}

/// beta in D = beta K of all terms but contact, seen in one smooth motion; NaN where that is not so.
double damping_time(World& world, const VecX& drag) {
  const dynamics::StateView view = world.state.view();
  const Eigen::Index size = world.state.layout().u_size;
  VecX x(size), Kx = VecX::Zero(size), Dx = VecX::Zero(size);
  for (Eigen::Index i = 0; i < size; ++i) x[i] = std::sin(0.7 * static_cast<double>(i) + 1.0);
  for (const auto& term : world.system.terms()) {
    if (!term->traits().has_tangent || term->traits().contact) continue;
    term->apply_tangent(view, 1.0, 0.0, x, Kx);
    term->apply_tangent(view, 0.0, 1.0, x, Dx);
  }
  Dx -= drag.cwiseProduct(x);
  const double beta = Kx.dot(Dx) / Kx.squaredNorm();
  return (Dx - beta * Kx).norm() <= kProportional * Dx.norm() || Dx.norm() == 0.0 ? beta : NAN;
}

}  // namespace

/// The contact's columns K_nt, B_nt and rows K_tn, B_tn as combinations of few: an orthonormal basis Q of
/// their span, of as many columns as they have directions that differ (three for a plane region, whose
/// samples have one normal: a push and two tilts), by Gram and Schmidt with the largest first.
struct Condenser::Columns {
  MatX Q;              ///< 3 nodes x r, of the nodes of the linearisation, in their order
  MatX K_nt, B_nt;     ///< r x 6: Q^T K_nt ...
  MatX K_tn, B_tn;     ///< 6 x r: K_tn Q ...
  double lever = 1.0;  ///< of the contact [m]: what turns a force into the moment of the same column

  /// @param held  directions that do not answer
  Columns(const contact::FrameLinearisation& c, double H, const std::vector<char>& held) {
    const auto nodes = static_cast<Eigen::Index>(c.nodes.size());
    MatX all(3 * nodes, 24);
    for (Eigen::Index k = 0; k < nodes; ++k) {
      const contact::NodeCoupling& one = c.nodes[static_cast<std::size_t>(k)];
      all.middleRows<3>(3 * k) << one.K_body, one.B_body, one.K_frame.transpose(), one.B_frame.transpose();
      for (int axis = 0; axis < 3; ++axis)
        if (held[static_cast<std::size_t>(3 * one.node + axis)]) all.row(3 * k + axis).setZero();
    }
    const double push = all.middleCols<3>(3).norm(), turn = all.leftCols<3>().norm();
    if (push > 0.0 && turn > 0.0) lever = turn / push;
    MatX left = all;  // in one unit: forces of a displacement of H v, or of a lever's turn by it
    for (Eigen::Index k = 0; k < 24; k += 3)
      left.middleCols<3>(k) *= (k % 6 == 0 ? 1.0 / lever : 1.0) * (k % 12 < 6 ? H : 1.0);
    MatX basis(3 * nodes, 24);
    Eigen::Index count = 0;
    double least = 0.0;
    for (; count < 24; ++count) {
      Eigen::Index largest = 0;
      const double norm = std::sqrt(left.colwise().squaredNorm().maxCoeff(&largest));
      if (count == 0) least = kNegligible * norm;
      if (!(norm > least)) break;
      auto direction = basis.col(count);
      direction = left.col(largest) / norm;
      direction -= basis.leftCols(count) * (basis.leftCols(count).transpose() * direction).eval();
      direction.normalize();
      left -= direction * (direction.transpose() * left).eval();
    }
    Q = basis.leftCols(count);
    const MatX in_basis = Q.transpose() * all;
    K_nt = in_basis.middleCols<6>(0);
    B_nt = in_basis.middleCols<6>(6);
    K_tn = in_basis.middleCols<6>(12).transpose();
    B_tn = in_basis.middleCols<6>(18).transpose();
  }
};

bool Condenser::answer(World& world, double period, double tick, const contact::FrameLinearisation& c,
                       CondensedAnswer& after_period, CondensedAnswer& after_tick) {
  ++counters_.condensed;
  if (error_ > 0.0 && iterate(world, period, tick, c, after_period, after_tick)) return true;
  ++counters_.factored;
  if (!factor(world, period, c, after_period)) return false;
  after_tick = after_period;
  return !(tick < period) || factor(world, tick, c, after_tick);
}

// One matrix serves both times.  Where the elements' damping is beta times their stiffness, K_e,
//     A(H) = M + H drag + (H^2 + H beta) K_e + H^2 K_c + H D_c,
// the tick's is that of the period with a share of K_e, and masses and contact of its own.
bool Condenser::iterate(World& world, double period, double tick, const contact::FrameLinearisation& c,
                        CondensedAnswer& after_period, CondensedAnswer& after_tick) {
  const dynamics::StateView view = world.state.view();
  if (!assembly_) assembly_ = std::make_unique<dynamics::StepAssembly>(world.system);
  if (!assembly_->applies(view)) return false;
  VecX s, w, f, g;
  known_motion(world, period, s, w);
  dynamics::ZeroRowSumMatrix& A = response_.step_matrix(assembly_->pattern());
  assembly_->assemble(view, s, 1.0, period, period * period, f, A);
  if (response_.take_step_matrix() != SolveStatus::kOk) return false;
  VecX right = period * f;
  if (!w.isZero(0.0)) {
    assembly_->residual(view, s, w, period, right);
  } else {
    for (int dof : world.system.driven_dofs()) right[dof] = 0.0;
  }
  const Columns columns(c, period, world.system.driven_mask());
  if (!solve(StepResponse::Which::kMatrix, period, columns, right, c, after_period, g)) return false;
  after_period.wrench += c.wrench_of_nodes(s, w);
  after_period.J.topLeftCorner<3, 3>() += rotating_arms(world, period, s, w, g, after_) - c.geometric;

  after_tick = after_period;
  if (!(tick < period)) return true;
  const VecX drag = (A.diagonal - world.system.nodal_mass()) / period;
  if (damping_time_s_ == -1.0) damping_time_s_ = damping_time(world, drag);
  if (std::isnan(damping_time_s_)) return false;
  known_motion(world, tick, s, w);
  assembly_->residual(view, s, w, tick, right);
  points_.clear();
  scratch_.setZero(right.size());
  f = scratch_;
  world.contact->add_step(view, scratch_, tick * tick, tick, f, points_);
  const double share = tick * (tick + damping_time_s_) / (period * (period + damping_time_s_));
  response_.set_variant(share, world.system.nodal_mass() + tick * drag, points_);
  if (!solve(StepResponse::Which::kVariant, tick, columns, right, c, after_tick, g)) return false;
  after_tick.wrench += c.wrench_of_nodes(s, w);
  after_tick.J.topLeftCorner<3, 3>() += rotating_arms(world, tick, s, w, g, after_) - c.geometric;
  return true;
}

// With B = [Q, r] the iteration gives S = Q^T A^-1 Q and Q^T A^-1 r, and what their diagonal misses, m.  The
// rest of an entry is at most the root of m_i m_j (of Cauchy and Schwarz), so that
//     |J - J_exact| <= H |C Q| sqrt(m) sqrt(m)^T |Q^T K_nt|,
// entry by entry, and alike for B and the wrench.
bool Condenser::solve(StepResponse::Which which, double H, const Columns& columns, const VecX& right,
                      const contact::FrameLinearisation& c, CondensedAnswer& out, VecX& g) {
  if (response_.point_stiffness(which) > kStiffContact) return false;
  const Eigen::Index r = columns.Q.cols();
  rhs_.setZero(right.size(), r + 1);
  for (std::size_t k = 0; k < c.nodes.size(); ++k)
    rhs_.block(3 * c.nodes[k].node, 0, 3, r) = columns.Q.middleRows<3>(3 * static_cast<Eigen::Index>(k));
  rhs_.col(r) = right;
  const MatX C = H * columns.K_tn + columns.B_tn;
  Vec6 unit = Vec6::Ones();
  unit.head<3>() /= columns.lever;
  const auto size = [&](const Mat6& m) { return (unit.asDiagonal() * m * unit.asDiagonal()).norm(); };
  SolveStatus status = response_.begin(which, rhs_);
  const long before = response_.products();
  for (int k = 0; status == SolveStatus::kOk; ++k) {
    const MatX& S = response_.response();
    out.J = -c.K + H * C * S.topLeftCorner(r, r) * columns.K_nt;
    out.B = -c.B + H * C * S.topLeftCorner(r, r) * columns.B_nt;
    out.wrench = wrench_of(c) - C * S.col(r).head(r);
    const VecX m = response_.missing().head(r).cwiseMax(0.0).cwiseSqrt();
    const double m_r = std::sqrt(std::max(response_.missing()[r], 0.0));
    const VecX to_tool = C.cwiseAbs() * m;
    const double J = size(out.J), stiffest = std::max(size(out.B), H * J);
    const Mat6 terms = H * C.cwiseAbs() * S.topLeftCorner(r, r).cwiseAbs() * columns.K_nt.cwiseAbs();
    if (!(kRounding * size(terms) <= error_ * J)) return false;
    const double error = std::max(
        {size(H * to_tool * (m.transpose() * columns.K_nt.cwiseAbs())) / J,
         size(H * to_tool * (m.transpose() * columns.B_nt.cwiseAbs())) / stiffest,
         m_r * unit.cwiseProduct(to_tool).norm() /
             std::max(unit.cwiseProduct(out.wrench).norm(), unit.cwiseProduct(wrench_of(c)).norm())});
    if (error <= error_) {
      counters_.largest_error = std::max(counters_.largest_error, error);
      break;
    }
    if (k == kMostIterations) return false;
    status = response_.advance();
  }
  counters_.products += response_.products() - before;
  if (status != SolveStatus::kOk || !out.J.allFinite() || !out.wrench.allFinite()) return false;
  response_.solution(r, g);
  return true;
}

/// A factor of the step matrix: by LU where it is indefinite (an inverted element, a compressed strut), null
/// where it is singular.
dynamics::LinearSolver* Condenser::factored(bool symmetric) {
  if (!solver_) solver_ = linear::make_linear_solver(symmetric ? "cholmod" : "umfpack");
  const SolveStatus status = solver_->factor(matrix_);
  if (status == SolveStatus::kOk) return solver_.get();
  if (status != SolveStatus::kIndefinite) return nullptr;
  counters::count("loop.condensed_by_lu");
  if (!lu_) lu_ = linear::make_linear_solver("umfpack");
  return lu_->factor(matrix_) == SolveStatus::kOk ? lu_.get() : nullptr;
}

bool Condenser::factor(World& world, double H, const contact::FrameLinearisation& c, CondensedAnswer& out) {
  world.system.step_matrix(world.state.view(), 1.0, H, H * H, matrix_);
  dynamics::LinearSolver* solver = factored(world.system.symmetric());
  if (!solver) return false;
  VecX s, w;
  known_motion(world, H, s, w);
  MatX rhs = MatX::Zero(world.state.layout().u_size, 13);
  for (const contact::NodeCoupling& one : c.nodes)
    rhs.block<3, 12>(3 * one.node, 0) << one.K_body, one.B_body;
  rhs.col(12) = right_hand_side(world, H, s, w);
  VecX column;
  for (Eigen::Index i = 0; i < 12; ++i) {
    column = rhs.col(i);
    world.system.reduce(world.state.view(), column);
    rhs.col(i) = column;
  }
  MatX solved(rhs.rows(), rhs.cols());
  if (solver->solve(rhs, solved) != SolveStatus::kOk || !all_finite(solved)) return false;
  for (Eigen::Index i = 0; i < solved.cols(); ++i) {
    column = solved.col(i);
    world.system.expand(world.state.view(), column);
    solved.col(i) = column;
  }
  const VecX g = solved.col(12);
  out.J = -c.K;
  out.B = -c.B;
  out.wrench = wrench_of(c) + c.wrench_of_nodes(s + H * g, w + g);
  for (const contact::NodeCoupling& one : c.nodes) {
    const Eigen::Matrix<double, 6, 3> C = H * one.K_frame + one.B_frame;
    out.J += H * C * solved.block<3, 6>(3 * one.node, 0);
    out.B += H * C * solved.block<3, 6>(3 * one.node, 6);
  }
  out.J.topLeftCorner<3, 3>() += rotating_arms(world, H, s, w, g, after_) - c.geometric;
  return true;
}

}  // namespace palpate::loop
