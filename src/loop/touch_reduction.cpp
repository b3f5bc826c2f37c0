#include "touch_reduction.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "palpate/contact/contact_force.h"
#include "palpate/core/counters.h"
#include "palpate/core/finite.h"
#include "step_answer.h"

namespace palpate::loop {

// Galerkin's reduction of the bodies to what the tool can do to them.  X: the answers of their linearly
// implicit step over the period H (linearise.cpp) to six load patterns, twelve with friction, and to none:
//     X = A^-1 [ sum N_j^T K_j Z_j,  H (f - K s - D w) - M w ],     A = M + H D + H^2 K, the contact in K, D,
// N_j the map from nodes to sample j.  The first are the directions in which nodes answer a moving tool, with
// the contact as it is in between; the last is where they go by themselves.  With displacements tau v + X y
// (v = s/H), tested against X:
//     X^T M X y'' + X^T D X y' + X^T K X y = X^T (f - M w/H) - tau X^T (K v + D w/H) + contact,
// whose step over H answers as that of all nodes does, exactly, since that is in the span; within the period
// it knows their inertia.  The samples' own part is taken out of f, K and D again: the ticks put it in, as it
// is at each of them.
//
// X need not be exact: whatever it spans, the reduced bodies are those of a finer constraint, passive, and
// what they answer less is of second order in the error of X.  So X comes from a few steps of conjugate
// gradients (step_response.h), which start from the last exchange's.  These give X^T A X besides, and from it
//     X^T K X of the elements = (X^T A X - (1 + H a) X^T M X - contact) / (H^2 + H b),     D = a M + b K,
// a and b of the body that is touched: where materials differ, the step over H is still exact, and what part
// of it is damping is not.
//
// Modes: y = S q, S^T X^T M X S = 1, S^T X^T K X S = diag(k).  Directions that are combinations of the others
// to kAlike are left out; k < 0 (an inverted element) and what D has of negative is taken for zero.
using contact::TouchModel;
using contact::TouchSample;

struct TouchReduction::Answers {
  MatX X;             ///< u_size x patterns and one
  MatX A;             ///< X^T A X; empty: not known
  VecX s, w, f;       ///< f: all forces
  VecX stiff;         ///< K s + D w
};

/// All but the samples of the tool, in X.
struct TouchReduction::Reduced {
  MatX M, K, D;
  VecX f, rate;
};

namespace {

constexpr int kModes = TouchModel::kMostModes, kMostIterations = 40;
using PointModes = Eigen::Matrix<double, 3, kModes>;
using Mat36 = Eigen::Matrix<double, 3, 6>;

/// Squares of lengths, of directions scaled to one: of exact answers, and of single precision's.
constexpr double kAlike = 1e-9, kAlikeSingle = 1e-6;

/// 3 x m: the rows of X that move a sample.
MatX rows_of(const contact::SurfacePoint& point, const MatX& X) {
  MatX out = MatX::Zero(3, X.cols());
  for (int i = 0; i < point.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out += point.weight[k] * X.middleRows<3>(3 * point.node[k]);
  }
  return out;
}

bool presses(const TouchSample& sample) { return sample.gap < 0.0; }

/// Load patterns: those of the samples that press; where none does, of those that may come to.
MatX load_patterns(const World& world, const std::vector<TouchSample>& samples, const Pose& pose) {
  const bool pressed = std::any_of(samples.begin(), samples.end(), presses);
  const auto& contacts = world.description.contacts;
  const bool friction =
      std::any_of(contacts.begin(), contacts.end(), [](const ContactSpec& c) { return c.friction > 0.0; });
  MatX out = MatX::Zero(world.state.layout().u_size, friction ? 12 : 6);
  const Mat3 R = pose.rotation.toRotationMatrix();
  for (const TouchSample& s : samples) {
    if (pressed && !presses(s)) continue;
    Mat36 Z;
    Z << -cross_matrix(R * s.tool.offset + s.tool.slide), Mat3::Identity();
    const Mat3 K = pressed ? s.K : s.would_be;
    Eigen::Matrix<double, 3, 12> load;
    load << K * Z, K.trace() * (Mat3::Identity() - s.normal * s.normal.transpose()) * Z;
    for (int i = 0; i < s.body.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      out.middleRows<3>(3 * s.body.node[k]) += s.body.weight[k] * load.leftCols(out.cols());
    }
  }
  return out;
}

/// y = (k K + d D) x of all forces, in nodes' and bones' directions.
VecX tangent_times(World& world, double k, double d, const VecX& x) {
  VecX out = VecX::Zero(x.size());
  for (const auto& term : world.system.terms())
    if (term->traits().has_tangent) term->apply_tangent(world.state.view(), k, d, x, out);
  if (k == 0.0) return out;
  VecX carried = VecX::Zero(x.size());
  world.system.apply_carried_stiffness(world.state.view(), x, carried);
  return out + k * carried;
}

MatX products(Eigen::Index columns, const MatX& X, const auto& product) {
  MatX out(X.rows(), columns);
  for (Eigen::Index i = 0; i < columns; ++i) out.col(i) = product(VecX(X.col(i)));
  return X.transpose() * out;
}

/// Symmetric, with what is negative taken for zero.
MatX definite(const MatX& A) {
  const Eigen::SelfAdjointEigenSolver<MatX> eigen(MatX(0.5 * (A + A.transpose())));
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// a and b of the body whose node that is.
std::pair<double, double> damping_of(const World& world, int node) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const dynamics::Block* block = world.state.layout().find(world.bodies[i].block_id);
    const int first = block ? block->u_offset / 3 : 0;
    if (!block || node < first || node >= first + block->u_size / 3) continue;
    const SoftBodySpec& spec = world.description.bodies[i];
    return {spec.mass_damping_per_s, spec.stiffness_damping_s};
  }
  return {0.0, 0.0};
}

}  // namespace

TouchReduction::TouchReduction(World& world, double error) : error_(error), assembly_(world.system) {
  if (error > 0.0) response_ = std::make_unique<linear::StepResponse>(world.description.integrator.threads);
}
TouchReduction::~TouchReduction() = default;

/// False where that is not for this system, or found no end.
bool TouchReduction::iterate(World& world, double H, const MatX& patterns, Answers& out) {
  using dynamics::SolveStatus;
  const dynamics::StateView view = world.state.view();
  if (!response_ || !assembly_.applies(view)) return false;
  dynamics::ZeroRowSumMatrix& A = response_->step_matrix(assembly_.pattern());
  VecX r;
  assembly_.assemble(view, out.s, 1.0, H, H * H, r, A);
  if (response_->take_step_matrix() != SolveStatus::kOk) return false;
  out.stiff = out.f - r;
  MatX rhs(patterns.rows(), patterns.cols() + 1);
  rhs.leftCols(patterns.cols()) = patterns;
  if (out.w.isZero(0.0)) {
    rhs.rightCols<1>() = H * r;
  } else {
    assembly_.residual(view, out.s, out.w, H, r);
    rhs.rightCols<1>() = r;
    out.stiff += tangent_times(world, 0.0, 1.0, out.w);
  }
  for (int dof : world.system.driven_dofs()) rhs.row(dof).setZero();
  SolveStatus status = response_->begin(rhs);
  for (int k = 0; status == SolveStatus::kOk && k < kMostIterations; ++k) {
    const VecX answer = response_->response().diagonal();
    if ((response_->missing().array() <= error_ * answer.array()).head(patterns.cols()).all()) break;
    status = response_->advance();
    counters::count("loop.touch_iterations");
  }
  if (status != SolveStatus::kOk) return false;
  out.X.resize(rhs.rows(), rhs.cols());
  VecX column;
  for (Eigen::Index k = 0; k < rhs.cols(); ++k) {
    response_->solution(k, column);
    out.X.col(k) = column;
  }
  out.A = response_->energies();
  return all_finite(out.X) && all_finite(out.A);
}

/// False where the step matrix has no factor.
bool TouchReduction::factor(World& world, double H, const MatX& patterns, Answers& out) {
  const dynamics::StateView view = world.state.view();
  world.system.step_matrix(view, 1.0, H, H * H, ToolSide::of(world).condensed_matrix);
  dynamics::LinearSolver* solver = factored(ToolSide::of(world));
  if (!solver) return false;
  counters::count("loop.touch_factored");
  out.stiff = tangent_times(world, 1.0, 0.0, out.s) + tangent_times(world, 0.0, 1.0, out.w);
  MatX rhs(patterns.rows(), patterns.cols() + 1);
  VecX column;
  for (Eigen::Index i = 0; i < patterns.cols(); ++i) {
    column = patterns.col(i);
    world.system.reduce(view, column);
    rhs.col(i) = column;
  }
  rhs.rightCols<1>() = right_hand_side(world, H, out.s, out.w);
  out.X.resize(rhs.rows(), rhs.cols());
  if (solver->solve(rhs, out.X) != dynamics::SolveStatus::kOk || !all_finite(out.X)) return false;
  for (Eigen::Index i = 0; i < out.X.cols(); ++i) {
    column = out.X.col(i);
    world.system.expand(view, column);
    out.X.col(i) = column;
  }
  out.A.resize(0, 0);
  return true;
}

namespace {

/// S, m x modes, of M, K and D in X, and what the model has of it.
MatX modes_of(const MatX& M, const MatX& K, const MatX& D, double alike, TouchModel& out) {
  VecX scale = M.diagonal();
  for (double& one : scale) one = one > 0.0 ? 1.0 / std::sqrt(one) : 0.0;
  const Eigen::SelfAdjointEigenSolver<MatX> mass(
      MatX(scale.asDiagonal() * (0.5 * (M + M.transpose())) * scale.asDiagonal()));
  const VecX& lengths = mass.eigenvalues();  // increasing
  const Eigen::Index all = lengths.size(),
                     alone = (lengths.array() > alike * std::max(lengths[all - 1], 0.0)).count(),
                     kept = std::min<Eigen::Index>(kModes, alone);
  MatX S = scale.asDiagonal() * mass.eigenvectors().rightCols(kept) *
           lengths.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  const MatX k = S.transpose() * K * S;
  const Eigen::SelfAdjointEigenSolver<MatX> stiffness(MatX(0.5 * (k + k.transpose())));
  S = (S * stiffness.eigenvectors()).eval();
  out.modes = static_cast<int>(kept);
  Eigen::Map<VecX>(out.stiffness.data(), kept) = stiffness.eigenvalues().cwiseMax(0.0);
  Eigen::Map<MatX>(out.damping.data(), kModes, kModes).topLeftCorner(kept, kept) =
      definite(S.transpose() * D * S);
  return S;
}

}  // namespace

bool TouchReduction::reduce(World& world, double H, TouchModel& out) {
  const ToolSide& side = ToolSide::of(world);
  const dynamics::StateView view = world.state.view();
  out = {};
  out.time = world.state.time();
  std::vector<TouchSample> samples = world.contact->touch_samples(view, side.frame_index);
  if (samples.empty()) return true;
  Answers x;
  known_motion(world, H, x.s, x.w);
  for (TouchSample& sample : samples) sample.velocity = rows_of(sample.body, x.s / H);
  world.system.force(view, x.f);
  const MatX patterns = load_patterns(world, samples, side.known.pose);
  const bool known = iterate(world, H, patterns, x) || factor(world, H, patterns, x);
  std::vector<PointModes> modes(samples.size(), PointModes::Zero());
  if (known) {
    const MatX& X = x.X;
    const Eigen::Index m = X.cols();
    VecX product;
    const auto mass = [&](const VecX& v) {
      world.system.apply_mass(view, v, product);
      return product;
    };
    const MatX M = products(m, X, mass);
    MatX K, D;
    if (x.A.size() > 0) {
      const auto contact = [&](double k, double d) {
        return products(m, X, [&](const VecX& v) {
          product.setZero(v.size());
          world.contact->apply_tangent(view, k, d, v, product);
          return product;
        });
      };
      const MatX contact_K = contact(1.0, 0.0), contact_D = contact(0.0, 1.0);
      const auto [a, b] = damping_of(world, samples.front().body.node[0]);
      const MatX elements =
          (x.A - (1.0 + H * a) * M - H * H * contact_K - H * contact_D) / (H * H + H * b);
      K = elements + contact_K;
      D = a * M + b * elements + contact_D;
    } else {
      K = products(m, X, [&](const VecX& v) { return tangent_times(world, 1.0, 0.0, v); });
      D = products(m, X, [&](const VecX& v) { return tangent_times(world, 0.0, 1.0, v); });
    }
    VecX f = X.transpose() * (x.f - mass(x.w) / H), rate = -(X.transpose() * x.stiff) / H;
    std::vector<MatX> rows;
    rows.reserve(samples.size());
    for (const TouchSample& sample : samples) {
      const MatX& P = rows.emplace_back(rows_of(sample.body, X));
      if (!presses(sample)) continue;
      K -= P.transpose() * sample.K * P;
      D -= P.transpose() * sample.D * P;
      f += P.transpose() * sample.force;
      rate += P.transpose() * (sample.K * sample.velocity + sample.D * rows_of(sample.body, x.w / H));
    }
    const MatX S = modes_of(M, K, D, x.A.size() > 0 ? kAlikeSingle : kAlike, out);
    Eigen::Map<VecX>(out.force.data(), S.cols()) = S.transpose() * f;
    Eigen::Map<VecX>(out.force_rate.data(), S.cols()) = S.transpose() * rate;
    for (std::size_t j = 0; j < samples.size(); ++j) modes[j].leftCols(S.cols()) = rows[j] * S;
  }
  contact::gather_points(samples, side.known.pose, modes, out);
  return known;
}

}  // namespace palpate::loop
