#include "condenser.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/clock.h"
#include "palpate/core/counters.h"
#include "palpate/core/finite.h"
#include "palpate/linear/solvers.h"
#include "tool_side.h"

namespace palpate::loop {

using dynamics::SolveStatus;
using linear::StepResponse;

namespace {

/// Directions of contact's columns and rows that are smaller than these by so much are left out.
constexpr double kNegligible = 1e-5;
/// Iterations after which a factorisation is the safer bet.
constexpr int kMostIterations = 60;
/// Contact so much stiffer than the body's nodes is factorised.
constexpr double kStiffContact = 50.0;
/// Rounding of S, relative: J is what large terms leave where contact is far stiffer than the body.
constexpr double kRounding = 1e-5;

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
Mat3 rotating_arms(World& world, double H, const VecX& s, const VecX& w, const VecX& g) {
  VecX q = moved(world, s + H * g), u = world.state.u() + w + g;
  world.system.impose(world.state.layout(), world.state.time() + H, q.data(), u.data());
  return world.contact->geometric_stiffness(world.state.view(),
                                            world.state.view(world.state.time(), q.data(), u.data()),
                                            ToolSide::of(world).frame_index);
}

Vec6 wrench_of(const contact::FrameLinearisation& c) {
  Vec6 out;
  out << c.wrench.moment, c.wrench.force;
  return out;
}

/// What turns a force into the moment of the same displacement [m].
double lever_of(const contact::FrameLinearisation& c) {
  double push = 0.0, turn = 0.0;
  for (const contact::NodeCoupling& one : c.nodes) {
    push += one.K_body.rightCols<3>().squaredNorm();
    turn += one.K_body.leftCols<3>().squaredNorm();
  }
  return push > 0.0 && turn > 0.0 ? std::sqrt(turn / push) : 1.0;
}

/// Euclidean (Frobenius) norms with rotations measured at a lever, and moments as forces there.
class Norm {
 public:
  explicit Norm(double lever) { unit_.head<3>() /= lever; }
  double of(const Vec6& wrench) const { return unit_.cwiseProduct(wrench).norm(); }
  double of(const Mat6& m) const { return (unit_.asDiagonal() * m * unit_.asDiagonal()).norm(); }

 private:
  Vec6 unit_ = Vec6::Ones();
};

}  // namespace

/// The contact's columns K_nt, B_nt and rows C = H K_tn + B_tn as combinations of few: an orthonormal basis Q
/// of their span, of as many columns as they have directions that differ (three for a plane region, whose
/// samples have one normal: a push and two tilts), by Gram and Schmidt with the largest first.  Each of the
/// three is left out to a part of itself: J is made of products of them, and where friction damps, C may be
/// a thousand times H K_nt.
struct Condenser::Columns {
  MatX Q;           ///< 3 nodes x r, of the nodes of the linearisation, in their order
  MatX K_nt, B_nt;  ///< r x 6: Q^T K_nt, Q^T B_nt
  MatX C;           ///< 6 x r: (H K_tn + B_tn) Q
  double lever;     ///< lever_of the contact

  /// @param held  directions that do not answer
  Columns(const contact::FrameLinearisation& c, double H, const std::vector<char>& held)
      : lever(lever_of(c)) {
    const auto nodes = static_cast<Eigen::Index>(c.nodes.size());
    MatX all(3 * nodes, 18);
    for (Eigen::Index k = 0; k < nodes; ++k) {
      const contact::NodeCoupling& one = c.nodes[static_cast<std::size_t>(k)];
      all.middleRows<3>(3 * k) << one.K_body, one.B_body, (H * one.K_frame + one.B_frame).transpose();
      for (int axis = 0; axis < 3; ++axis)
        if (held[static_cast<std::size_t>(3 * one.node + axis)]) all.row(3 * k + axis).setZero();
    }
    MatX left = all;
    for (Eigen::Index k = 0; k < 18; k += 6) {
      left.middleCols<3>(k) /= lever;
      if (const double size = left.middleCols<6>(k).norm(); size > 0.0) left.middleCols<6>(k) /= size;
    }
    MatX basis(3 * nodes, 18);
    Eigen::Index count = 0;
    for (; count < 18; ++count) {
      Eigen::Index largest = 0;
      const double norm = std::sqrt(left.colwise().squaredNorm().maxCoeff(&largest));
      if (!(norm > kNegligible)) break;
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
    C = in_basis.middleCols<6>(12).transpose();
  }
};

bool Condenser::answer(World& world, double period, double tick, const contact::FrameLinearisation& c,
                       CondensedAnswer& after_period, CondensedAnswer& after_tick) {
  ++counters_.exchanges;
  bool known = false;
  {
    const ScopedTimer timer(counters_.seconds);
    known = solve(world, period, tick, c, after_period, after_tick);
  }
  if (known && check_) check(world, period, tick, c, after_period, after_tick);
  return known;
}

bool Condenser::solve(World& world, double period, double tick, const contact::FrameLinearisation& c,
                      CondensedAnswer& after_period, CondensedAnswer& after_tick) {
  if (error_ > 0.0 && iterate(world, period, tick, c, after_period, after_tick)) return true;
  ++counters_.factored;
  if (!factor(world, period, c, after_period)) return false;
  after_tick = after_period;
  return !(tick < period) || factor(world, tick, c, after_tick);
}

void Condenser::check(World& world, double period, double tick, const contact::FrameLinearisation& c,
                      const CondensedAnswer& after_period, const CondensedAnswer& after_tick) {
  CondensedAnswer exact, exact_tick;
  if (!factor(world, period, c, exact) || !factor(world, std::min(tick, period), c, exact_tick)) return;
  ++counters_.checked;
  const Norm norm(lever_of(c));
  const Twist twist = ToolSide::of(world).tool->twist();
  Vec6 v;
  v << twist.angular, twist.linear;
  const auto wrench = [&](double H, const CondensedAnswer& a, const CondensedAnswer& b) {
    const Vec6 of_a = a.wrench + H * (a.J * v), of_b = b.wrench + H * (b.J * v);
    counters_.wrench_difference =
        std::max(counters_.wrench_difference,
                 norm.of(Vec6(of_a - of_b)) / std::max(norm.of(of_b), norm.of(wrench_of(c))));
  };
  wrench(period, after_period, exact);
  wrench(std::min(tick, period), after_tick, exact_tick);
  const double J = norm.of(exact.J);
  counters_.stiffness_difference =
      std::max(counters_.stiffness_difference, norm.of(Mat6(after_period.J - exact.J)) / J);
  counters_.damping_difference =
      std::max(counters_.damping_difference,
               norm.of(Mat6(after_period.B - exact.B)) / std::max(norm.of(exact.B), period * J));
}

bool Condenser::iterate(World& world, double period, double tick, const contact::FrameLinearisation& c,
                        CondensedAnswer& after_period, CondensedAnswer& after_tick) {
  // with friction J differs by a quarter from the factored one, for a reason that is not known yet
  for (const ContactSpec& spec : world.description.contacts)
    if (spec.friction > 0.0) return false;
  if (!assembly_) assembly_ = std::make_unique<dynamics::StepAssembly>(world.system);
  if (!assembly_->applies(world.state.view())) return false;
  if (!iterate(of_period_, world, period, c, after_period)) return false;
  after_tick = after_period;
  return !(tick < period) || iterate(of_tick_, world, tick, c, after_tick);
}

bool Condenser::iterate(StepResponse& response, World& world, double H, const contact::FrameLinearisation& c,
                        CondensedAnswer& out) {
  const dynamics::StateView view = world.state.view();
  VecX s, w, right, g;
  known_motion(world, H, s, w);
  dynamics::ZeroRowSumMatrix& A = response.step_matrix(assembly_->pattern());
  assembly_->assemble(view, s, 1.0, H, H * H, right, A);
  if (response.take_step_matrix() != SolveStatus::kOk) return false;
  right *= H;
  if (!w.isZero(0.0)) {
    assembly_->residual(view, s, w, H, right);
  } else {
    for (int dof : world.system.driven_dofs()) right[dof] = 0.0;
  }
  const Columns columns(c, H, world.system.driven_mask());
  if (!solve(response, H, columns, right, c, out, g)) return false;
  out.wrench += c.wrench_of_nodes(s, w);
  out.J.topLeftCorner<3, 3>() += rotating_arms(world, H, s, w, g) - c.geometric;
  return true;
}

// With B = [Q, r] the iteration gives S = Q^T A^-1 Q and Q^T A^-1 r, and what their diagonal misses, m.  The
// rest of an entry is at most the root of m_i m_j (of Cauchy and Schwarz), so that
//     |J - J_exact| <= H |C Q| sqrt(m) sqrt(m)^T |Q^T K_nt|,
// entry by entry, and alike for B and the wrench.
bool Condenser::solve(StepResponse& response, double H, const Columns& columns, const VecX& right,
                      const contact::FrameLinearisation& c, CondensedAnswer& out, VecX& g) {
  if (response.point_stiffness() > kStiffContact) return false;
  const Eigen::Index r = columns.Q.cols();
  rhs_.setZero(right.size(), r + 1);
  for (std::size_t k = 0; k < c.nodes.size(); ++k)
    rhs_.block(3 * c.nodes[k].node, 0, 3, r) = columns.Q.middleRows<3>(3 * static_cast<Eigen::Index>(k));
  rhs_.col(r) = right;
  const MatX& C = columns.C;
  const Norm norm(columns.lever);
  SolveStatus status = response.begin(rhs_);
  const long before = response.products();
  for (int k = 0; status == SolveStatus::kOk; ++k) {
    const MatX& S = response.response();
    out.J = -c.K + H * C * S.topLeftCorner(r, r) * columns.K_nt;
    out.B = -c.B + H * C * S.topLeftCorner(r, r) * columns.B_nt;
    out.wrench = wrench_of(c) - C * S.col(r).head(r);
    const VecX m = response.missing().head(r).cwiseMax(0.0).cwiseSqrt();
    const double m_r = std::sqrt(std::max(response.missing()[r], 0.0));
    const Vec6 to_tool = C.cwiseAbs() * m;
    const double J = norm.of(out.J), stiffest = std::max(norm.of(out.B), H * J),
                 wrench = std::max(norm.of(out.wrench), norm.of(wrench_of(c)));
    const Mat6 terms = H * C.cwiseAbs() * S.topLeftCorner(r, r).cwiseAbs() * columns.K_nt.cwiseAbs();
    if (!(kRounding * norm.of(terms) <= error_ * J)) return false;
    const double error =
        std::max({norm.of(Mat6(H * to_tool * (m.transpose() * columns.K_nt.cwiseAbs()))) / J,
                  norm.of(Mat6(H * to_tool * (m.transpose() * columns.B_nt.cwiseAbs()))) / stiffest,
                  m_r * norm.of(to_tool) / wrench});
    if (error <= error_) {
      counters_.largest_error = std::max(counters_.largest_error, error);
      break;
    }
    if (k == kMostIterations) return false;
    status = response.advance();
  }
  counters_.readings += response.products() - before;
  if (status != SolveStatus::kOk || !out.J.allFinite() || !out.wrench.allFinite()) return false;
  response.solution(r, g);
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
  out.J.topLeftCorner<3, 3>() += rotating_arms(world, H, s, w, g) - c.geometric;
  return true;
}

}  // namespace palpate::loop
