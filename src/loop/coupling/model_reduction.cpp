#include "model_reduction.h"

#include <algorithm>

#include "contact_loads.h"
#include "core/counters.h"
#include "core/finite.h"
#include "reduced_system.h"

namespace palpate::loop {

// Galerkin reduction of the bodies to their possible responses to the tool. X contains the responses in their
// linearly implicit step over the period H (condensation.cpp) to six load patterns, twelve with friction, and
// without a load:
//     X = A^-1 [ sum N_j^T K_j Z_j,  H (f - K s - D w) - M w ],     A = M + H D + H^2 K, the contact in K, D,
// with N_j the map from nodes to sample j. The former are the directions in which nodes respond to a moving
// tool, with the contact acting in between; the latter is the motion without tool motion. With displacements
// tau v + X y (v = s/H), tested with X:
//     X^T M X y'' + X^T D X y' + X^T K X y = X^T (f - M w/H) - tau X^T (K v + D w/H) + contact,
// (and + tau X^T rate if other tools press the bodies, rate_by_other_tools in implicit_step.h). Its step over
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

/// Returns the damping coefficients of the body with that node.
ReductionOptions::Damping damping_of(const dynamics::Layout& layout,
                                     const std::vector<ReductionOptions::Damping>& bodies, int node) {
  for (const ReductionOptions::Damping& body : bodies) {
    const dynamics::Block* block = layout.find(body.block_id);
    const int first = block ? block->u_offset / 3 : 0;
    if (block && node >= first && node < first + block->u_size / 3) return body;
  }
  return {-1, 0.0, 0.0};
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

ModelReduction::ModelReduction(dynamics::System& system, ReductionOptions options)
    : options_(std::move(options)), assembly_(system), responses_(std::make_unique<StepResponses>()) {
  if (options_.error > 0.0) response_ = std::make_unique<linear::StepResponse>(options_.threads);
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
bool ModelReduction::iterate(const CoupledTool& tool, double H, StepResponses& out) {
  using dynamics::SolveStatus;
  const dynamics::StateView view = tool.state.view();
  if (!response_ || view.layout->border_size() > 0 || !assembly_.applies(view)) return false;
  dynamics::ZeroRowSumMatrix& A = response_->step_matrix(assembly_.pattern());
  VecX r;
  assembly_.assemble(view, out.s, 1.0, H, H * H, r, A, options_.keep);
  if (response_->take_step_matrix() != SolveStatus::kOk) return false;
  out.stiff = out.f - r;
  MatX& rhs = out.loads;
  const Eigen::Index loads = spread_patterns(out, tool.state.layout().u_size);
  if (out.w.isZero(0.0)) {
    rhs.rightCols<1>() = H * r;
  } else {
    assembly_.residual(view, out.s, out.w, H, r);
    rhs.rightCols<1>() = r;
    out.stiff += tangent_times(tool.system, view, 0.0, 1.0, out.w);
  }
  if (out.rate.size() > 0) rhs.rightCols<1>() += H * H * out.rate;
  for (int dof : tool.system.driven_dofs()) rhs.row(dof).setZero();
  SolveStatus status = response_->begin(rhs);
  // Cauchy-Schwarz bound on the work of the loads, each of length one, on the motion without load.
  const VecX energy = response_->response().diagonal() + response_->residual_energies();
  if (loads > 0 && H * std::sqrt(energy.head(loads).maxCoeff() * energy[loads]) <= out.still) {
    rhs.rightCols<1>().setZero();
    status = response_->begin(rhs);
  }
  for (int k = 0; status == SolveStatus::kOk && k < kMostIterations; ++k) {
    const VecX answer = response_->response().diagonal();
    if ((response_->error_bound().array() <= options_.error * answer.array()).head(loads).all()) break;
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
bool ModelReduction::factorise(const CoupledTool& tool, double H, StepResponses& out) {
  const dynamics::StateView view = tool.state.view();
  dynamics::LinearSolver* solver = factor_.of(tool.system, view, H);
  if (!solver) return false;
  counters::count("loop.touch_factored");
  out.stiff =
      tangent_times(tool.system, view, 1.0, 0.0, out.s) + tangent_times(tool.system, view, 0.0, 1.0, out.w);
  MatX& rhs = out.loads;
  const Eigen::Index loads = spread_patterns(out, tool.state.layout().u_size);
  VecX column;
  for (Eigen::Index i = 0; i < loads; ++i) {
    column = rhs.col(i);
    tool.system.reduce(view, column);
    rhs.col(i) = column;
  }
  rhs.rightCols<1>() = right_hand_side(tool.system, tool.state, H, out.s, out.w, out.rate);
  out.X.resize(rhs.rows(), rhs.cols());
  if (solver->solve(rhs, out.X) != dynamics::SolveStatus::kOk || !all_finite(out.X)) return false;
  out.work = out.X.transpose() * rhs;
  out.exact = true;
  for (Eigen::Index i = 0; i < out.X.cols(); ++i) {
    column = out.X.col(i);
    tool.system.expand(view, column);
    out.X.col(i) = column;
  }
  return true;
}

void ModelReduction::prepare(const dynamics::State& state, double H) {
  const dynamics::StateView view = state.view();
  if (!response_ || view.layout->border_size() > 0 || !assembly_.applies(view)) return;
  dynamics::ZeroRowSumMatrix& A = response_->step_matrix(assembly_.pattern());
  VecX r;
  assembly_.assemble(view, VecX::Zero(state.layout().u_size), 1.0, H, H * H, r, A, options_.keep);
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
bool ModelReduction::update_friction(const CoupledTool& tool, double H,
                                     const std::vector<ReducedSample>& samples,
                                     const std::vector<ReducedTangent>& tangents) {
  const StepResponses& x = *responses_;
  const Mat3 R = tool.motion.pose.rotation.toRotationMatrix();
  const Twist& v = tool.motion.twist;
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
  contact::FrameStep step{.frame = tool.frame};
  step.moved = H * stacked(v);
  return tool.contact.improve_step(tool.state.view(), x.s + H * change, x.w + change, step, options_.error);
}

/// Computes X.  @param samples  renumbers their nodes and sets their velocities  @return false if there is no
/// X
bool ModelReduction::answer(const CoupledTool& tool, double H, std::vector<ReducedSample>& samples,
                            const std::vector<ReducedTangent>& tangents) {
  StepResponses& x = *responses_;
  x.nodes = number_nodes(samples);
  for (ReducedSample& sample : samples)
    sample.velocity = moved_by(
        sample, [&](int k) { return Vec3(x.s.segment<3>(3 * x.nodes[static_cast<std::size_t>(k)]) / H); });
  tool.system.force(tool.state.view(), x.f);
  x.patterns =
      load_patterns(tool.motion, options_.has_friction, samples, tangents, x.nodes.size(), H, kModes - 1);
  x.error_bound = 0.0;
  return iterate(tool, H, x) || factorise(tool, H, x);
}

bool ModelReduction::reduce(const CoupledTool& tool, double H, ReducedContactModel& out) {
  const dynamics::StateView view = tool.state.view();
  out = {};
  out.time = tool.state.time();
  std::vector<ReducedTangent> tangents;
  std::vector<ReducedSample> samples = tool.contact.reduced_samples(view, tool.frame, &tangents);
  if (samples.empty()) return true;
  out.samples = static_cast<int>(std::count_if(samples.begin(), samples.end(), presses));
  const contact::SecantTangents whatever_steps_have(tool.contact);
  StepResponses& x = *responses_;
  x.still = still_of(samples);
  known_motion(tool.system, tool.state, H, x.s, x.w);
  x.rate = rate_by_other_tools(tool);
  const FrictionOfPeriod friction(tool.contact, view);
  if (friction.has_friction) samples = tool.contact.reduced_samples(view, tool.frame, &tangents);
  bool exchanged = answer(tool, H, samples, tangents);
  while (exchanged && friction.has_friction && !update_friction(tool, H, samples, tangents)) {
    counters::count("loop.touch_bases_anew");
    samples = tool.contact.reduced_samples(view, tool.frame, &tangents);
    exchanged = answer(tool, H, samples, tangents);
  }
  if (exchanged && x.exact)
    error_bound_.take_factored();
  else if (exchanged)
    error_bound_.take(x.error_bound, options_.error);
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
    const ReductionOptions::Damping d = damping_of(
        tool.state.layout(), options_.damping, x.nodes[static_cast<std::size_t>(samples.front().node[0])]);
    const MatX S = x.exact ? modes_of(reduce_exactly(tool, x.X, sums, x.product), kDependenceTolerance, out)
                           : modes_of(reduce_by_work(tool, H, x.X, x.work, sums, options_.others_touch,
                                                     d.mass, d.stiffness, x.product),
                                      kAlikeSingle, out);
    if (!x.w.isZero(0.0)) {
      VecX inertia;
      tool.system.apply_mass(view, x.w / H, inertia);
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
  contact::gather_points(samples, tool.motion.pose, modes, out);
  return exchanged;
}

}  // namespace palpate::loop
