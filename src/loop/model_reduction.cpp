#include "model_reduction.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "contact_loads.h"
#include "core/counters.h"
#include "core/finite.h"
#include "palpate/contact/contact_force.h"
#include "reduced_step.h"

namespace palpate::loop {

// Galerkin reduction of the bodies to their possible responses to the tool. X contains the responses in their
// linearly implicit step over the period H (linearise.cpp) to six load patterns, twelve with friction, and
// without a load:
//     X = A^-1 [ sum N_j^T K_j Z_j,  H (f - K s - D w) - M w ],     A = M + H D + H^2 K, the contact in K, D,
// with N_j the map from nodes to sample j. The former are the directions in which nodes respond to a moving
// tool, with the contact acting in between; the latter is the motion without tool motion. With displacements
// tau v + X y (v = s/H), tested with X:
//     X^T M X y'' + X^T D X y' + X^T K X y = X^T (f - M w/H) - tau X^T (K v + D w/H) + contact,
// (and + tau X^T rate if other tools press the bodies, rate_by_other_tools in reduced_step.h). Its step over
// H equals the step of all nodes exactly, since that is in the span; within the period it includes their
// inertia. The samples' part is removed from f, K and D: the ticks add it as it is at each tick.
//
// X need not be exact: for any span, the reduced bodies are more constrained and passive, and their response
// is too small by an error of second order in the error of X. X therefore comes from a few steps of conjugate
// gradients (step_response.h), which start from the last exchange's result. They also give X^T A X, and from
// it
//     X^T K X of the elements = (X^T A X - (1 + H a) X^T M X - contact) / (H^2 + H b),     D = a M + b K,
// with a and b of the body in contact: if materials differ, the step over H is still exact, but its split
// into damping and stiffness is not.
//
// In A, K and D friction is affine about the end of the period (contact/friction.h), as in the ticks and in a
// linearly implicit step, whichever tangent the steps of the bodies use; A is therefore symmetric with any
// friction. The end is predicted by X, for a tool that continues with its twist v: with K_t, D_t of the
// samples,
//     X^T A X y = X^T [last load] + H X^T N^T (K_t Z H v),
// and friction about that end gives the next A and X, until friction satisfies its law there. If samples
// slide in the same direction as before, or stick, the first X is final. The iteration covers only the tool's
// contact. All other friction is affine about the state: the velocities of sticking samples there are below
// the resolution of X, and friction about them would not converge. If sliding begins there, the tool receives
// it at the next exchange.
//
// A body at rest moves only by rounding. Its response without load, however small, would then span an
// additional, random direction (the rendered force depended on the method by which the body had come to rest,
// by 4e-5). It is omitted.
//
// A linearly implicit Euler step over H uses the same elements at the same state: their results are kept for
// it (dynamics::CachedStep), and for other tools.
//
// Modes: y = S q, S^T X^T M X S = 1, S^T X^T K X S = diag(k). Directions that are linear combinations of the
// others to kDependenceTolerance are omitted; k < 0 (an inverted element) and negative parts of D are
// replaced by zero.
using contact::ReducedContactModel;
using contact::ReducedSample;
using contact::ReducedTangent;

struct ModelReduction::StepResponses {
  std::vector<int> nodes;  ///< Nodes of the samples.
  MatX patterns;           ///< 3 nodes x patterns
  MatX X;                  ///< u_size x (patterns + 1)
  MatX work;               ///< X^T A X
  bool exact;              ///< A X = loads, to rounding.
  MatX loads, product;     ///< Scratch, as large as X.
  VecX s, w, f;            ///< f: all forces
  VecX stiff;              ///< K s + D w
  VecX rate;               ///< Rate of f due to other tools; empty: none.
  double still;            ///< Smaller displacements within the period count as rest [m].
  double error_bound;      ///< Relative error of the responses to the loads, upper bound.
};

namespace {

constexpr int kModes = ReducedContactModel::kMostModes, kMostIterations = 40;

/// Tolerances of linear dependence, for squared lengths of directions scaled to one: for exact and for
/// single-precision responses.
constexpr double kDependenceTolerance = 1e-9, kAlikeSingle = 1e-6;
/// Displacements within a period that count as rest: relative to the samples' gaps, and to their positions
/// (rounding).
constexpr double kRestTolerance = 1e-9, kStillByRounding = 1e-12;

/// Modes by rows, so that the values of one node are contiguous.
using Rows = Eigen::Matrix<double, kModes, Eigen::Dynamic>;

/// Returns the displacement within a period below which a body counts as at rest for the samples [m].
double still_of(const std::vector<ReducedSample>& samples) {
  double out = 0.0;
  for (const ReducedSample& s : samples)
    out = std::max(out, kRestTolerance * std::abs(s.gap) + kStillByRounding * s.place.norm());
  return out;
}

/// Returns the largest displacement of a sample due to a displacement of the nodes [m].
double farthest(const std::vector<ReducedSample>& samples, const VecX& displacement) {
  double out = 0.0;
  for (const ReducedSample& s : samples)
    out = std::max(out, moved_by(s, [&](int node) { return displacement.segment<3>(3 * node); }).norm());
  return out;
}

/// Returns the rows of the nodes' directions, node after node.
MatX rows_of(const auto& x, const std::vector<int>& nodes) {
  MatX out(3 * static_cast<Eigen::Index>(nodes.size()), x.cols());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    out.middleRows<3>(3 * static_cast<Eigen::Index>(k)) = x.template middleRows<3>(3 * nodes[k]);
  return out;
}

/// Returns y = (k K + d D) x for all forces, in directions of nodes and bones.
VecX tangent_times(World& world, double k, double d, const VecX& x) {
  VecX out = VecX::Zero(x.size());
  for (const auto& term : world.system.terms())
    if (term->traits().has_tangent) term->apply_tangent(world.state.view(), k, d, x, out);
  if (k == 0.0) return out;
  VecX carried = VecX::Zero(x.size());
  world.system.apply_carried_stiffness(world.state.view(), x, carried);
  return out + k * carried;
}

/// Returns X^T P X for a linear map P.  @param scratch  becomes P X, as large as X
MatX products(const MatX& X, MatX& scratch, const auto& product) {
  scratch.resize(X.rows(), X.cols());
  for (Eigen::Index i = 0; i < X.cols(); ++i) scratch.col(i) = product(VecX(X.col(i)));
  return X.transpose() * scratch;
}

/// Returns the symmetric part, with negative eigenvalues replaced by zero.
MatX definite(const MatX& A) {
  const Eigen::SelfAdjointEigenSolver<MatX> eigen(MatX(0.5 * (A + A.transpose())));
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// Returns the damping coefficients a and b of the body with that node.
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

void ReductionError::take(double error_bound, double requested) {
  ++exchanges;
  beyond_wanted += !(error_bound <= requested);
  largest = std::max(largest, error_bound);
  sum += error_bound;
}

void ReductionError::take_factored() {
  ++exchanges;
  ++factored;
}

void ReductionError::archive(Archive& a) {
  a("exchanges", exchanges);
  a("factored", factored);
  a("beyond_wanted", beyond_wanted);
  a("largest", largest);
  a("sum", sum);
}

ModelReduction::ModelReduction(World& world, double error, bool keep)
    : error_(error), keep_(keep), assembly_(world.system), responses_(std::make_unique<StepResponses>()) {
  if (error > 0.0) response_ = std::make_unique<linear::StepResponse>(world.description.integrator.threads);
}
ModelReduction::~ModelReduction() = default;

/// Writes the patterns in all directions, with an additional column behind them.  @return number of patterns
Eigen::Index ModelReduction::spread_patterns(StepResponses& x, Eigen::Index size) {
  const Eigen::Index loads = x.patterns.cols();
  x.loads.setZero(size, loads + 1);
  for (std::size_t k = 0; k < x.nodes.size(); ++k)
    x.loads.leftCols(loads).middleRows<3>(3 * x.nodes[k]) =
        x.patterns.middleRows<3>(3 * static_cast<Eigen::Index>(k));
  return loads;
}

/// Computes X by iteration. Returns false if the system is not supported, or without convergence.
bool ModelReduction::iterate(World& world, double H, StepResponses& out) {
  using dynamics::SolveStatus;
  const dynamics::StateView view = world.state.view();
  if (!response_ || !assembly_.applies(view)) return false;
  dynamics::ZeroRowSumMatrix& A = response_->step_matrix(assembly_.pattern());
  VecX r;
  assembly_.assemble(view, out.s, 1.0, H, H * H, r, A, keep_);
  if (response_->take_step_matrix() != SolveStatus::kOk) return false;
  out.stiff = out.f - r;
  MatX& rhs = out.loads;
  const Eigen::Index loads = spread_patterns(out, world.state.layout().u_size);
  if (out.w.isZero(0.0)) {
    rhs.rightCols<1>() = H * r;
  } else {
    assembly_.residual(view, out.s, out.w, H, r);
    rhs.rightCols<1>() = r;
    out.stiff += tangent_times(world, 0.0, 1.0, out.w);
  }
  if (out.rate.size() > 0) rhs.rightCols<1>() += H * H * out.rate;
  for (int dof : world.system.driven_dofs()) rhs.row(dof).setZero();
  SolveStatus status = response_->begin(rhs);
  // Cauchy-Schwarz bound on the work of the loads, each of length one, on the motion without load.
  const VecX energy = response_->response().diagonal() + response_->residual_energies();
  if (loads > 0 && H * std::sqrt(energy.head(loads).maxCoeff() * energy[loads]) <= out.still) {
    rhs.rightCols<1>().setZero();
    status = response_->begin(rhs);
  }
  for (int k = 0; status == SolveStatus::kOk && k < kMostIterations; ++k) {
    const VecX answer = response_->response().diagonal();
    if ((response_->error_bound().array() <= error_ * answer.array()).head(loads).all()) break;
    status = response_->advance();
    counters::count("loop.touch_iterations");
  }
  if (status != SolveStatus::kOk) return false;
  double error_bound = 0.0;
  for (Eigen::Index k = 0; k < loads; ++k)
    if (const double answer = response_->response()(k, k); answer > 0.0)
      error_bound = std::max(error_bound, response_->error_bound()[k] / answer);
  out.error_bound = error_bound;
  out.X.resize(rhs.rows(), rhs.cols());
  VecX column;
  for (Eigen::Index k = 0; k < rhs.cols(); ++k) {
    response_->solution(k, column);
    out.X.col(k) = column;
  }
  out.work = response_->energies();
  out.exact = false;
  return all_finite(out.X) && all_finite(out.work);
}

/// Computes X by factorisation. Returns false if the step matrix has no factor.
bool ModelReduction::factor(World& world, ToolInstance& side, double H, StepResponses& out) {
  const dynamics::StateView view = world.state.view();
  world.system.step_matrix(view, 1.0, H, H * H, side.condensed_matrix);
  dynamics::LinearSolver* solver = factored(world.system, side);
  if (!solver) return false;
  counters::count("loop.touch_factored");
  out.stiff = tangent_times(world, 1.0, 0.0, out.s) + tangent_times(world, 0.0, 1.0, out.w);
  MatX& rhs = out.loads;
  const Eigen::Index loads = spread_patterns(out, world.state.layout().u_size);
  VecX column;
  for (Eigen::Index i = 0; i < loads; ++i) {
    column = rhs.col(i);
    world.system.reduce(view, column);
    rhs.col(i) = column;
  }
  rhs.rightCols<1>() = right_hand_side(world, H, out.s, out.w, out.rate);
  out.X.resize(rhs.rows(), rhs.cols());
  if (solver->solve(rhs, out.X) != dynamics::SolveStatus::kOk || !all_finite(out.X)) return false;
  out.work = out.X.transpose() * rhs;
  out.exact = true;
  for (Eigen::Index i = 0; i < out.X.cols(); ++i) {
    column = out.X.col(i);
    world.system.expand(view, column);
    out.X.col(i) = column;
  }
  return true;
}

namespace {

/// Computes the modes S, m x modes, from M, K and D in X, and stores their stiffness and damping in the
/// model.
MatX modes_of(const MatX& M, const MatX& K, const MatX& D, double alike, ReducedContactModel& out) {
  VecX scale = M.diagonal();
  for (double& one : scale) one = one > 0.0 ? 1.0 / std::sqrt(one) : 0.0;
  const Eigen::SelfAdjointEigenSolver<MatX> mass(
      MatX(scale.asDiagonal() * (0.5 * (M + M.transpose())) * scale.asDiagonal()));
  const VecX& lengths = mass.eigenvalues();  // ascending
  const Eigen::Index all = lengths.size(),
                     alone = (lengths.array() > alike * std::max(lengths[all - 1], 0.0)).count(),
                     kept = std::min<Eigen::Index>(kModes, alone);
  out.modes = static_cast<int>(kept);
  if (kept == 0) return MatX(all, 0);  // every node that responds is held
  MatX S = scale.asDiagonal() * mass.eigenvectors().rightCols(kept) *
           lengths.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  const MatX k = S.transpose() * K * S;
  const Eigen::SelfAdjointEigenSolver<MatX> stiffness(MatX(0.5 * (k + k.transpose())));
  S = (S * stiffness.eigenvectors()).eval();
  Eigen::Map<VecX>(out.stiffness.data(), kept) = stiffness.eigenvalues().cwiseMax(0.0);
  Eigen::Map<MatX>(out.damping.data(), kModes, kModes).topLeftCorner(kept, kept) =
      definite(S.transpose() * D * S);
  return S;
}

/// Contribution of the samples to the reduced system in X.
struct SampleSums {
  MatX K, D;
  VecX force;  ///< Force of the samples on the bodies.
  VecX stiff;  ///< K v + D w/H
};

/// @param X, mean_change  rows of the samples' nodes only
SampleSums sum_of(const std::vector<ReducedSample>& samples, const std::vector<ReducedTangent>& tangents,
                  const MatX& X, const VecX& mean_change) {
  const Eigen::Index m = X.cols();
  SampleSums out{MatX::Zero(m, m), MatX::Zero(m, m), VecX::Zero(m), VecX::Zero(m)};
  const auto nodes_of_X = [&](int node) { return X.middleRows<3>(3 * node); };
  const auto nodes_of_change = [&](int node) { return mean_change.segment<3>(3 * node); };
  for (std::size_t j = 0; j < samples.size(); ++j) {
    const ReducedSample& s = samples[j];
    if (!presses(s)) continue;
    const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kModes> P = moved_by(s, nodes_of_X);
    const auto& [K, D] = tangents[j];
    out.K.noalias() += P.transpose().lazyProduct((K * P).eval());
    out.D.noalias() += P.transpose().lazyProduct((D * P).eval());
    out.force.noalias() -= P.transpose() * s.force;
    out.stiff.noalias() += P.transpose() * (K * s.velocity + D * moved_by(s, nodes_of_change));
  }
  return out;
}

/// M, K and D in X, without the samples.
struct Reduced {
  MatX M, K, D;
};

/// @param work  X^T A X if X is not exact: K and D are computed from it  @param scratch  as large as X
Reduced reduced(World& world, const ToolInstance& side, double H, const MatX& X, const MatX* work,
                MatX& scratch, const SampleSums& sums, std::pair<double, double> damping) {
  const dynamics::StateView view = world.state.view();
  const Eigen::Index m = X.cols();
  const MatX &samples_K = sums.K, &samples_D = sums.D;
  Reduced out;
  VecX product;
  out.M = products(X, scratch, [&](const VecX& v) {
    world.system.apply_mass(view, v, product);
    return product;
  });
  if (!work) {
    out.K =
        products(X, scratch, [&](const VecX& v) { return tangent_times(world, 1.0, 0.0, v); }) - samples_K;
    out.D =
        products(X, scratch, [&](const VecX& v) { return tangent_times(world, 0.0, 1.0, v); }) - samples_D;
    return out;
  }
  // Contact of bodies with obstacles, each other and other tools.
  MatX others_K = MatX::Zero(m, m), others_D = others_K;
  const auto& contacts = world.description.contacts;
  if (!std::all_of(contacts.begin(), contacts.end(),
                   [&](const ContactSpec& c) { return names(c, side.name); })) {
    const auto contact = [&](double k, double d) {
      return products(X, scratch, [&](const VecX& v) {
        product.setZero(v.size());
        world.contact->apply_tangent(view, k, d, v, product);
        return product;
      });
    };
    others_K = contact(1.0, 0.0) - samples_K;
    others_D = contact(0.0, 1.0) - samples_D;
  }
  const auto [a, b] = damping;
  const MatX elements =
      (*work - (1.0 + H * a) * out.M - H * H * (samples_K + others_K) - H * (samples_D + others_D)) /
      (H * H + H * b);
  out.K = elements + others_K;
  out.D = a * out.M + b * elements + others_D;
  return out;
}

}  // namespace

void ModelReduction::prepare(World& world, double H) {
  const dynamics::StateView view = world.state.view();
  if (!response_ || !assembly_.applies(view)) return;
  dynamics::ZeroRowSumMatrix& A = response_->step_matrix(assembly_.pattern());
  VecX r;
  assembly_.assemble(view, VecX::Zero(world.state.layout().u_size), 1.0, H, H * H, r, A, keep_);
  response_->take_step_matrix();
}

namespace {

/// Scope in which friction is affine about the end of a period.
struct FrictionOfPeriod {
  FrictionOfPeriod(contact::ContactForce& force, const dynamics::StateView& state)
      : contact_force(force), has_friction(force.begin_step(state)) {}
  ~FrictionOfPeriod() {
    if (has_friction) contact_force.end_step();
  }
  FrictionOfPeriod(const FrictionOfPeriod&) = delete;
  FrictionOfPeriod& operator=(const FrictionOfPeriod&) = delete;

  contact::ContactForce& contact_force;
  bool has_friction;
};

}  // namespace

/// Updates friction from the end of the period that X predicts. Returns false if friction does not yet
/// satisfy its law there.
bool ModelReduction::update_friction(World& world, const ToolInstance& side, double H,
                                     const std::vector<ReducedSample>& samples,
                                     const std::vector<ReducedTangent>& tangents) {
  const StepResponses& x = *responses_;
  const Mat3 R = side.exchanged.pose.rotation.toRotationMatrix();
  const Twist& v = side.exchanged.twist;
  VecX load = x.X.transpose() * x.loads.rightCols<1>();
  for (std::size_t j = 0; j < samples.size(); ++j) {
    const ReducedSample& s = samples[j];
    if (!presses(s)) continue;
    const Vec3 moved = H * v.at(R * s.offset + s.slide), push = H * (tangents[j].K * moved);
    load +=
        moved_by(s, [&](int node) { return x.X.middleRows<3>(3 * x.nodes[static_cast<std::size_t>(node)]); })
            .transpose() *
        push;
  }
  const VecX change = x.X * x.work.completeOrthogonalDecomposition().solve(load);
  contact::FrameStep tool{.frame = side.frame_index};
  tool.moved << H * v.angular, H * v.linear;
  return world.contact->improve_step(world.state.view(), x.s + H * change, x.w + change, tool, error_);
}

/// Computes X.  @param samples  renumbers their nodes and sets their velocities  @return false if there is no
/// X
bool ModelReduction::answer(World& world, ToolInstance& side, double H, std::vector<ReducedSample>& samples,
                            const std::vector<ReducedTangent>& tangents) {
  StepResponses& x = *responses_;
  x.nodes = number_nodes(samples);
  for (ReducedSample& sample : samples)
    sample.velocity = moved_by(
        sample, [&](int k) { return Vec3(x.s.segment<3>(3 * x.nodes[static_cast<std::size_t>(k)]) / H); });
  world.system.force(world.state.view(), x.f);
  x.patterns = load_patterns(world, side, samples, tangents, x.nodes.size(), H, kModes - 1);
  x.error_bound = 0.0;
  return iterate(world, H, x) || factor(world, side, H, x);
}

bool ModelReduction::reduce(World& world, ToolInstance& side, double H, ReducedContactModel& out) {
  const dynamics::StateView view = world.state.view();
  out = {};
  out.time = world.state.time();
  std::vector<ReducedTangent> tangents;
  std::vector<ReducedSample> samples = world.contact->reduced_samples(view, side.frame_index, &tangents);
  if (samples.empty()) return true;
  out.samples = static_cast<int>(std::count_if(samples.begin(), samples.end(), presses));
  const contact::SecantTangents whatever_steps_have(*world.contact);
  StepResponses& x = *responses_;
  x.still = still_of(samples);
  known_motion(world, H, x.s, x.w);
  x.rate = rate_by_other_tools(world, side);
  const FrictionOfPeriod friction(*world.contact, view);
  if (friction.has_friction) samples = world.contact->reduced_samples(view, side.frame_index, &tangents);
  bool exchanged = answer(world, side, H, samples, tangents);
  while (exchanged && friction.has_friction && !update_friction(world, side, H, samples, tangents)) {
    counters::count("loop.touch_bases_anew");
    samples = world.contact->reduced_samples(view, side.frame_index, &tangents);
    exchanged = answer(world, side, H, samples, tangents);
  }
  if (exchanged && x.exact)
    error_bound_.take_factored();
  else if (exchanged)
    error_bound_.take(x.error_bound, error_);
  const VecX change = rows_of(x.w, x.nodes) / H;
  Rows modes = Rows::Zero(kModes, change.size());
  MatX near;
  if (exchanged) near = rows_of(x.X, x.nodes);
  if (exchanged && farthest(samples, H * near.rightCols<1>()) <= x.still) {
    const Eigen::Index loads = x.patterns.cols();
    x.X.conservativeResize(Eigen::NoChange, loads);
    near.conservativeResize(Eigen::NoChange, loads);
    x.work.conservativeResize(loads, loads);
  }
  if (exchanged && x.X.cols() > 0) {
    const SampleSums sums = sum_of(samples, tangents, near, change);
    const Reduced r = reduced(world, side, H, x.X, x.exact ? nullptr : &x.work, x.product, sums,
                              damping_of(world, x.nodes[static_cast<std::size_t>(samples.front().node[0])]));
    const MatX S = modes_of(r.M, r.K, r.D, x.exact ? kDependenceTolerance : kAlikeSingle, out);
    if (!x.w.isZero(0.0)) {
      VecX inertia;
      world.system.apply_mass(view, x.w / H, inertia);
      x.f -= inertia;
    }
    const Eigen::Index kept = S.cols();
    Eigen::Map<VecX>(out.force.data(), kept) = S.transpose() * (x.X.transpose() * x.f - sums.force);
    Eigen::Map<VecX>(out.force_rate.data(), kept) =
        S.transpose() * (sums.stiff - x.X.transpose() * x.stiff / H);
    if (x.rate.size() > 0)
      Eigen::Map<VecX>(out.force_rate.data(), kept) += S.transpose() * (x.X.transpose() * x.rate);
    modes.topRows(kept).noalias() = S.transpose() * near.transpose();
  }
  contact::gather_points(samples, side.exchanged.pose, modes, out);
  return exchanged;
}

}  // namespace palpate::loop
