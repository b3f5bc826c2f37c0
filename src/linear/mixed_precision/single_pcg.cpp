#include <algorithm>
#include <cmath>
#include <utility>

#include "core/clock.h"
#include "core/counters.h"
#include "dynamics/energy_tolerance.h"
#include "dynamics/mixed_precision_step.h"
#include "linear/make.h"
#include "linear/mixed_precision/refinement.h"
#include "linear/mixed_precision/single_solve.h"
#include "linear/settings.h"
#include "palpate/core/error.h"

namespace palpate::linear {
namespace {

using dynamics::BlockSparse;
using dynamics::BorderedMatrix;
using dynamics::SolveStatus;
using dynamics::StepMatrixUse;
using dynamics::ZeroRowSumMatrix;

/// Smallest relative tolerance: below it the residual in double is rounding.
constexpr double kTightestSingle = 1e-13;
/// Relative rounding error of single precision; and the admissible value, in tolerances, of the bound derived
/// below for a body one element thick.
constexpr double kSingleRounding = 0x1p-24, kRoundingShare = 4.0;
/// Number of matrices of a pattern that are requested in double after one that was too coarse. The cause may
/// have been contact outside the pattern, which may end.
constexpr int kRefusedFor = 64;

/// Conjugate gradients in single precision on a copy of the matrix (36 bytes per block where double takes 72;
/// an iteration is one pass over it), corrected in double:
///     r = b - A x            double, by the original matrix
///     A d = r                single: the iteration
///     x += d, and again      until the error is small enough
/// The search continues across a new residual (the direction is made orthogonal to the last,
/// p . A p_last = 0), so that no progress is lost. Where the tolerance is a modest reduction of the initial
/// residual (1e-3), one residual suffices.
///
/// A zero-row-sum matrix has no original: its off-diagonal blocks are in single precision from the start
/// (single_matrix.h). The solution with A~ in place of A has the error
///     |x~ - x|_A <~ |A^-1/2 (A~ - A) A^-1/2| |x|_A.
/// A~ - A vanishes on translations, as K does: the energy of a wave of length l in it is e h^2 k (d/l)^2,
/// e = 2^-24, with k the stiffness of a node against its neighbours at the distance d. In A it is at least
/// m + h^2 k (d/l)^2, but m + h^2 k (d/l)^4 (t/d)^2 where the wave bends a body of thickness t, which to
/// first order rotates its parts. The ratio is greatest where both terms are equal, and then
///     e sqrt(s) d/(2 t),   s = 1 + h^2 k/m the squared Courant-type number (auto_solver.cpp);
/// roundings of both signs reduce it further. Bodies are several elements thick. Where e sqrt(s) exceeds
/// kRoundingShare tolerances, the matrix is not taken for A: the residual of the equations at an approximate
/// solution is evaluated, as for the matrix of an earlier step (refinement.h), and rounding then affects the
/// corrections only. The first approximation is the solution with A~.
///
/// Tolerance: linear_rtol bounds the error of the solution, |x - x*|_A <= linear_rtol |x*|_A, by
/// energy_bound.h. In a step A = M + h D + h^2 K, so the norm is the kinetic energy of the velocity change's
/// error plus the elastic energy of its displacement. A residual test, the usual criterion, bounds this error
/// only up to the condition number. A caller that accepts an absolute error (EnergyTolerance) saves the
/// digits below it.
///
/// Initial guess: projected_guess.h. Preconditioner: inverse 3x3 blocks, in `two-level` plus rigid clusters
/// (rigid_mode_coarse_space.h). Their E is recomputed when its age has cost as many additional iterations,
/// above the fewest since it was computed, as a new one costs. The cost is counted in operations, not in
/// seconds, so that results do not depend on timing.
///
/// Results are bitwise independent of the number of threads (cluster_team.h). They depend on the instruction
/// set, by rounding.
///
/// A border (a tool) changes the problem: such matrices are solved by "pcg", whose coarse space is the
/// border.
class SinglePcg final : public dynamics::LinearSolver,
                        public dynamics::MixedPrecisionSolver,
                        public dynamics::StepSolves,
                        public dynamics::EnergyTolerance {
 public:
  SinglePcg(std::string name, bool two_level, const IntegratorSpec& spec)
      : name_(std::move(name)),
        two_level_(two_level),
        rtol_(std::max(spec.linear_rtol, kTightestSingle)),
        spec_(spec),
        kernels_(node_kernels()),
        team_(spec.threads),
        copy_(kernels_, team_),
        state_(kernels_, team_, copy_, coarse_space_, rtol_, counters_),
        solve_(state_),
        refinement_(state_) {
    counters::count("integrate.solver." + name_);
  }

  std::string name() const override { return name_; }
  bool supports_unsymmetric() const override { return false; }
  const dynamics::SolverCounters& counters() const override {
    if (!bordered_) return counters_;
    sum_ = counters_;
    sum_ += bordered_->counters();
    return sum_;
  }

  void allow_error(double error) override { allowed_ = error; }

  SolveStatus factor(const BorderedMatrix& A) override {
    PALPATE_CHECK(A.symmetric, "solver {} was given an unsymmetric matrix", name_);
    delegated_ = A.border_size() > 0 || A.nodal_size() == 0;
    if (delegated_) {
      if (!bordered_) bordered_ = make_pcg(spec_);
      return bordered_->factor(A);
    }
    const bool same_values =
        matrix_ && copy_.analysed(A.body) && A.values_version != 0 && A.values_version == values_version_;
    matrix_ = &A;
    if (same_values) return status_;
    analyse(A.body);
    values_version_ = A.values_version;
    const ScopedTimer timer(counters_.factor_s);
    ++counters_.factorisations;
    ProjectedGuess& guess = state_.guess;
    status_ = copy_.take(A, guess.count(), guess.solutions(), guess.products());
    return use_copy(A.positions.size() == A.nodal_size() ? A.positions.data() : nullptr);
  }

  ZeroRowSumMatrix* step_matrix(const BlockSparse& pattern) override {
    if (pattern.block_rows() == 0) return nullptr;
    if (refused(pattern)) return nullptr;
    analyse(pattern);
    delegated_ = false;
    matrix_ = nullptr;
    use_ = StepMatrixUse::kNone;
    ZeroRowSumMatrix& room = copy_.room(pattern);
    room_ = &room;
    return &room;
  }

  StepMatrixUse factor_step_matrix() override {
    const ScopedTimer timer(counters_.factor_s);
    ++counters_.factorisations;
    ProjectedGuess& guess = state_.guess;
    status_ = copy_.take_step_matrix(guess.count(), guess.solutions(), guess.products());
    const bool coarse =
        !(kSingleRounding * std::sqrt(copy_.stiffness()) <= kRoundingShare * rtol_) || points_are_coarse();
    coarse_ = coarse;
    use_ = use_of(use_copy(room_->positions, coarse), coarse || copy_.bordered());
    return use_;
  }

  ZeroRowSumMatrix* lagged_matrix() override {
    const bool usable = use_ == StepMatrixUse::kRefine || use_ == StepMatrixUse::kSolve;
    return delegated_ || matrix_ || !usable ? nullptr : room_;
  }

  void renew_points() override {
    const ScopedTimer timer(counters_.factor_s);
    ProjectedGuess& guess = state_.guess;
    if (!copy_.renew_points(guess.count(), guess.solutions(), guess.products())) use_ = StepMatrixUse::kNone;
    refinement_.renew_points(coarse_ || points_are_coarse());
  }

  std::optional<SolveStatus> solve_by_refinement(dynamics::ResidualFunction& residual, VecX& x) override {
    if (delegated_ || matrix_ || (use_ != StepMatrixUse::kRefine && use_ != StepMatrixUse::kSolve)) return {};
    const long before = counters_.iterations;
    const bool own = use_ == StepMatrixUse::kRefine && !refined_;
    refinement_.allow_error(allowed_);
    const std::optional<SolveStatus> status =
        own && !refinement_.can_correct() ? refine_from_nothing(residual, x) : refinement_.solve(residual, x);
    if (!own) return status;
    refined_ = true;
    if (status != SolveStatus::kOk) use_ = StepMatrixUse::kNone;
    if (status == SolveStatus::kNotConverged) refuse();
    if (status == SolveStatus::kOk) account(before);
    return status;
  }

  SolveStatus solve(const VecX& b, VecX& x) override {
    if (delegated_) return bordered_->solve(b, x);
    check_right_hand_side(b.rows());
    const ScopedTimer timer(counters_.solve_s);
    x.resize(b.size());
    solve_.allow_error(allowed_);
    const SolveStatus status = solve_column(b.data(), x.data(), true);
    solve_.allow_error(0.0);
    return status;
  }

  Solved solve_first(const VecX& b, VecX& x, double share) override {
    const long before = counters_.iterations;
    const Solved out = approach(b, x, share, false);
    if (out.status == SolveStatus::kOk) account(before);
    return out;
  }

  Solved solve_next(const VecX& b, VecX& x, double share) override {
    {
      const ScopedTimer timer(counters_.factor_s);
      copy_.renew_points(0, nullptr, nullptr);
    }
    if (points_are_coarse()) return {SolveStatus::kNotConverged, false};
    return approach(b, x, share, true);
  }

  void end_solves(VecX& x) override {
    const ScopedTimer timer(counters_.solve_s);
    solve_.keep(x.data());
  }

  SolveStatus solve(const MatX& B, MatX& X) override {
    if (delegated_) return bordered_->solve(B, X);
    check_right_hand_side(B.rows());
    const ScopedTimer timer(counters_.solve_s);
    X.resize(B.rows(), B.cols());
    for (Eigen::Index c = 0; c < B.cols(); ++c)
      if (const SolveStatus status = solve_column(B.col(c).data(), X.col(c).data(), B.cols() == 1);
          status != SolveStatus::kOk)
        return status;
    return SolveStatus::kOk;
  }

 private:
  int nodes() const { return copy_.nodes(); }

  // --- per pattern
  void analyse(const BlockSparse& pattern) {
    if (copy_.analysed(pattern)) return;
    const ScopedTimer timer(counters_.symbolic_s);
    ++counters_.symbolic;
    const int n = pattern.block_rows();
    copy_.analyse(pattern, two_level_ ? two_level_sizes(n) : one_level_sizes(n));
    if (two_level_) coarse_space_.prepare(copy_.order());
    state_.prepare();
    solve_.prepare();
    refinement_.prepare();
  }

  // --- patterns whose zero-row-sum matrices were too coarse even for corrections
  bool refused(const BlockSparse& pattern) {
    if (refused_pattern_ == 0 || refused_pattern_ != pattern.pattern_version()) return false;
    if (--refused_for_ > 0) return true;
    refused_pattern_ = 0;
    return false;
  }
  void refuse() {
    refused_pattern_ = room_->pattern->pattern_version();
    refused_for_ = kRefusedFor;
  }

  /// Whether contact is so much stiffer than the adjacent nodes that its rounding affects their motions too.
  bool points_are_coarse() const {
    return !(kSingleRounding * copy_.point_stiffness() <= kRoundingShare * rtol_);
  }

  // --- per matrix
  SolveStatus use_copy(const double* positions, bool rounded = false) {
    state_.guess.products_are_known(status_ == SolveStatus::kOk);
    refinement_.renew(rounded, copy_.bordered());
    refined_ = false;
    coarse_space_.serve(copy_.scale());
    if (status_ == SolveStatus::kOk && two_level_ && extra_iterations_ >= refresh_cost())
      refresh_clusters(positions);
    return status_;
  }

  static StepMatrixUse use_of(SolveStatus copied, bool coarse) {
    if (copied == SolveStatus::kIndefinite) return StepMatrixUse::kIndefinite;
    if (copied != SolveStatus::kOk) return StepMatrixUse::kNone;
    return coarse ? StepMatrixUse::kRefine : StepMatrixUse::kSolve;
  }

  /// Refines a first solution: refinement corrects an initial guess, and where there is none yet, the guess
  /// is the solution with the rounded matrix, whose right-hand side is the residual of zero.
  std::optional<SolveStatus> refine_from_nothing(dynamics::ResidualFunction& equations, VecX& x) {
    x.setZero(3 * nodes());
    equations.at(x, right_hand_side_);
    {
      const ScopedTimer timer(counters_.solve_s);
      solve_.allow_error(allowed_);
      const SolveStatus status = solve_.solve(right_hand_side_.data(), x.data(), true);
      solve_.allow_error(0.0);
      // still no guess: the right-hand side is zero, and so is the solution
      if (status != SolveStatus::kOk || !refinement_.can_correct()) return status;
    }
    return refinement_.solve(equations, x);
  }

  /// Returns the cost of a new E and D in iterations, by operation counts.
  double refresh_cost() const {
    if (!coarse_space_.ready()) return 0.0;
    const double size = coarse_space_.size(), blocks = copy_.block_count();
    return (size * size * size + 60.0 * blocks) / (9.0 * blocks + 50.0 * nodes() + size * size);
  }

  void refresh_clusters(const double* positions) {
    coarse_space_.refresh(copy_, positions, kernels_);
    ++counters_.refreshes;
    extra_iterations_ = 0.0;
    min_iterations_ = HUGE_VAL;
  }

  // --- per right-hand side
  void check_right_hand_side(Eigen::Index rows) const {
    PALPATE_CHECK(status_ == SolveStatus::kOk && (matrix_ || use_ == StepMatrixUse::kSolve),
                  "solver {}: solve() called before factor()", name_);
    PALPATE_CHECK(!matrix_ || matrix_->values_version == values_version_,
                  "solver {}: the matrix changed between factor and solve", name_);
    PALPATE_CHECK(rows == 3 * nodes(), "right-hand side has {} rows, the matrix {}", rows, 3 * nodes());
  }

  SolveStatus solve_column(const double* b, double* x, bool remember) {
    ++counters_.solves;
    const long before = counters_.iterations;
    const SolveStatus status = solve_.solve(b, x, remember);
    if (status != SolveStatus::kOk) return status;
    if (remember) refinement_.solved(state_.correction);
    account(before);
    return status;
  }

  /// Solves within a step that solves several times.
  Solved approach(const VecX& b, VecX& x, double share, bool again) {
    check_right_hand_side(b.rows());
    const ScopedTimer timer(counters_.solve_s);
    ++counters_.solves;
    x.resize(b.size());
    bool accurate = false;
    const SolveStatus status = solve_.approach(b.data(), x.data(), again, share, accurate);
    return {status, accurate};
  }

  /// Adds up the iterations that the age of E costs, for the decision in use_copy().
  void account(long iterations_before) {
    const auto iterations = static_cast<double>(counters_.iterations - iterations_before);
    if (!two_level_ || iterations == 0.0) return;
    min_iterations_ = std::min(min_iterations_, iterations);
    extra_iterations_ += iterations - min_iterations_;
  }

  std::string name_;
  bool two_level_;
  double rtol_, allowed_ = 0.0;
  IntegratorSpec spec_;
  const NodeKernels& kernels_;
  ClusterTeam team_;
  dynamics::SolverCounters counters_;
  mutable dynamics::SolverCounters sum_;
  std::unique_ptr<dynamics::LinearSolver> bordered_;  ///< built at the first matrix with a border
  bool delegated_ = false;

  const BorderedMatrix* matrix_ = nullptr;  ///< matrix of the last factor(); null: a zero-row-sum one
  ZeroRowSumMatrix* room_ = nullptr;
  std::uint64_t refused_pattern_ = 0;  ///< 0: none
  int refused_for_ = 0;                ///< matrices left until it is tried again
  VecX right_hand_side_;
  std::uint64_t values_version_ = 0;
  SolveStatus status_ = SolveStatus::kSingular;  ///< status of the copy
  StepMatrixUse use_ = StepMatrixUse::kNone;     ///< use of the zero-row-sum matrix
  bool coarse_ = false;   ///< the rounding of the zero-row-sum matrix is too coarse for solve()
  bool refined_ = false;  ///< the equations of a matrix for refinement were solved
  SingleMatrix copy_;
  RigidModeCoarseSpace coarse_space_;  ///< ready only in `two-level`
  double extra_iterations_ = 0.0,
         min_iterations_ = HUGE_VAL;  ///< since E's refresh: iterations above the fewest, the fewest
  SolveState state_;
  SingleSolve solve_;
  Refinement refinement_;
};

}  // namespace

std::unique_ptr<dynamics::LinearSolver> make_pcg_single(const IntegratorSpec& spec) {
  check_linear_rtol("pcg-single", spec);
  return std::make_unique<SinglePcg>("pcg-single", false, spec);
}

std::unique_ptr<dynamics::LinearSolver> make_pcg_two_level(const IntegratorSpec& spec) {
  check_linear_rtol("pcg-two-level", spec);
  return std::make_unique<SinglePcg>("pcg-two-level", true, spec);
}

}  // namespace palpate::linear
