#include <algorithm>
#include <array>
#include <cmath>

#include "core/counters.h"
#include "dynamics/energy_tolerance.h"
#include "dynamics/mixed_precision_step.h"
#include "linear/auto_choice.h"
#include "linear/make.h"
#include "linear/settings.h"
#include "palpate/core/error.h"
#include "palpate/linear/solvers.h"

namespace palpate::linear {
namespace {

using dynamics::BorderedMatrix;
using dynamics::SolveStatus;

/// A choice is kept until the matrix has become stiffer or softer by this factor, since a newly chosen solver
/// starts without earlier solutions.
constexpr double kKept = 4.0;
constexpr int kSampledRows = 512, kSampledRowsOfStepMatrix = 128;

}  // namespace

// The number of iterations per step depends on the ratio of stiffness to mass in A = M + h^2 K. A rigid
// translation causes no strain, so block row i of A sums to block row i of M, and
//     s = sum_i tr(A_ii) / sum_i tr(sum_j A_ij) = 1 + h^2 tr K / tr M,
// up to a constant the squared number of grid lengths that a sound wave travels in a step: one dimensionless
// number that combines step size, stiffness, density and mesh size. Rows of held nodes, and of their
// neighbours, which lack the held nodes' columns, are left out. A sample of some hundred rows of a large
// matrix is accurate enough to distinguish factors of four; reading every row in every step would cost one
// pass over the matrix.
double squared_courant_number(const dynamics::BlockSparse& A) {
  double own = 0.0, all = 0.0;
  const int stride = (A.block_rows() / kSampledRows) | 1;  // odd: not in phase with the rows of a grid
  for (int i = 0; i < A.block_rows(); i += stride) {
    double row = 0.0, diagonal = 0.0;
    bool beside_held = false;
    for (int s = A.row_start()[static_cast<std::size_t>(i)];
         s < A.row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
      const double* block = A.block(s);
      const double trace = block[0] + block[4] + block[8];
      row += trace;
      if (A.columns()[static_cast<std::size_t>(s)] == i)
        diagonal = trace;
      else
        beside_held = beside_held || std::all_of(block, block + 9, [](double value) { return value == 0.0; });
    }
    if (beside_held || !(row > 0.0)) continue;
    own += diagonal;
    all += row;
  }
  return all > 0.0 ? own / all : 1.0;
}

// Conjugate gradients with block Jacobi take a number of iterations that grows as sqrt(s) until the mesh
// diameter bounds it. With a coarse space the nodes per cluster bound it, and an iteration costs about a
// third more. Hence one threshold in s, independent of the number of nodes and of the tolerance. Measured for
// one step with each solver (beams of 81 to 11,172 nodes, linear_rtol of 1e-3 to 1e-9, one thread): for
// s >= 62 the coarse space is faster in all cases, by up to a factor of 11; for s <= 13 it costs up to 47 %
// and gains at most 14 %; at s = 31 both agree within 12 %. A Cholesky factor takes at least 2.2 times as
// long as the faster of the two.
bool prefers_two_level(double courant_squared) { return courant_squared >= 30.0; }

/// Returns squared_courant_number() of a zero-row-sum matrix, whose row sums are stored.
static double squared_courant_number(const dynamics::ZeroRowSumMatrix& A) {
  double stiffness = 0.0, mass = 0.0;
  const int rows = A.pattern->block_rows(), stride = (rows / kSampledRowsOfStepMatrix) | 1;
  for (int i = 0; i < rows; i += stride) {
    mass += A.diagonal.segment<3>(3 * i).sum();
    for (int s = A.pattern->row_start()[static_cast<std::size_t>(i)];
         s < A.pattern->row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
      if (A.pattern->columns()[static_cast<std::size_t>(s)] == i) continue;
      const float* block =
          A.values.data() + 9 * static_cast<std::size_t>(A.slot_map[static_cast<std::size_t>(s)]);
      stiffness -= block[0] + block[4] + block[8];
    }
  }
  return 1.0 + stiffness / (A.scale * mass);
}

namespace {

/// Delegates to conjugate gradients with or without a coarse space, chosen by the matrix's squared Courant
/// number, and to GMRES for unsymmetric matrices. For a matrix in double precision the number is computed
/// before a solver takes the matrix. A zero-row-sum matrix is written in the order of one solver, so the
/// first goes to kTwoLevel, which handles both stiff and soft matrices; each matrix's number decides which
/// solver takes the next one.
class AutoSolver final : public dynamics::LinearSolver,
                         public dynamics::MixedPrecisionSolver,
                         public dynamics::StepSolves,
                         public dynamics::EnergyTolerance {
 public:
  explicit AutoSolver(const IntegratorSpec& spec) : spec_(spec) { counters::count("integrate.solver.auto"); }
  std::string name() const override { return "auto"; }
  bool supports_unsymmetric() const override { return true; }
  bool supports_indefinite() const override { return false; }

  SolveStatus factor(const BorderedMatrix& A) override {
    if (!A.symmetric) return factor_unsymmetric(A);
    if (active_ == unsymmetric_.get()) active_ = nullptr;
    const bool same = active_ && A.values_version != 0 && A.values_version == values_version_;
    if (!same) choose(A.body.block_rows(), squared_courant_number(A.body));
    values_version_ = A.values_version;
    seen_ = 0.0;
    return active_->factor(A);
  }
  dynamics::ZeroRowSumMatrix* step_matrix(const dynamics::BlockSparse& pattern) override {
    if (pattern.block_rows() != nodes_) {
      provisional_ = true;
      activate(kTwoLevel);
      nodes_ = pattern.block_rows();
    } else if (seen_ > 0.0) {
      choose(nodes_, seen_);
    } else if (!mixed_) {
      activate(last_);  // GMRES has solved an unsymmetric matrix in between
    }
    return room_ = mixed_ ? mixed_->step_matrix(pattern) : nullptr;
  }
  dynamics::StepMatrixUse factor_step_matrix() override {
    PALPATE_CHECK(room_, "solver auto: factor_step_matrix() called before step_matrix()");
    seen_ = squared_courant_number(*room_);
    values_version_ = 0;
    return mixed_->factor_step_matrix();
  }
  dynamics::ZeroRowSumMatrix* lagged_matrix() override { return mixed_ ? mixed_->lagged_matrix() : nullptr; }
  void renew_points() override { mixed_->renew_points(); }
  std::optional<SolveStatus> solve_by_refinement(dynamics::ResidualFunction& residual, VecX& x) override {
    return mixed_ ? mixed_->solve_by_refinement(residual, x) : std::nullopt;
  }
  Solved solve_first(const VecX& b, VecX& x, double share) override {
    return step_solves().solve_first(b, x, share);
  }
  Solved solve_next(const VecX& b, VecX& x, double share) override {
    return step_solves().solve_next(b, x, share);
  }
  void end_solves(VecX& x) override { step_solves().end_solves(x); }
  void allow_error(double error) override {
    allowed_ = error;
    if (auto* tolerance = dynamic_cast<dynamics::EnergyTolerance*>(active_)) tolerance->allow_error(error);
  }
  SolveStatus solve(const MatX& B, MatX& X) override { return chosen().solve(B, X); }
  SolveStatus solve(const VecX& b, VecX& x) override { return chosen().solve(b, x); }

  const dynamics::SolverCounters& counters() const override {
    sum_ = retired_;
    for (const auto& solver : made_) {
      if (!solver) continue;
      sum_ += solver->counters();
    }
    if (unsymmetric_) sum_ += unsymmetric_->counters();
    if (active_) sum_.ordering = active_->counters().ordering;
    return sum_;
  }

 private:
  static constexpr std::array kNames{"pcg-single", "pcg-two-level"};
  static constexpr std::size_t kSingle = 0, kTwoLevel = 1;

  dynamics::LinearSolver& chosen() {
    PALPATE_CHECK(active_, "solver auto: solve() called before factor()");
    return *active_;
  }
  dynamics::StepSolves& step_solves() { return dynamic_cast<dynamics::StepSolves&>(chosen()); }
  dynamics::LinearSolver& made(std::size_t k) {
    if (!made_[k]) made_[k] = make_linear_solver(kNames[k], spec_);
    return *made_[k];
  }
  void activate(std::size_t k) {
    last_ = k;
    active_ = &made(k);
    mixed_ = dynamic_cast<dynamics::MixedPrecisionSolver*>(active_);
    allow_error(allowed_);
  }

  SolveStatus factor_unsymmetric(const BorderedMatrix& A) {
    if (!unsymmetric_) unsymmetric_ = make_gmres(spec_);
    active_ = unsymmetric_.get();
    mixed_ = nullptr;
    values_version_ = 0;
    seen_ = 0.0;
    return active_->factor(A);
  }

  void choose(int nodes, double stiffness) {
    const bool near = !provisional_ && stiffness < kKept * stiffness_ && kKept * stiffness > stiffness_;
    if (active_ && nodes == nodes_ && (near || !std::isfinite(stiffness))) return;
    nodes_ = nodes;
    stiffness_ = std::isfinite(stiffness) ? stiffness : 1.0;
    activate(prefers_two_level(stiffness_) ? kTwoLevel : kSingle);
    if (provisional_ && active_ != made_[kTwoLevel].get()) {
      retired_ += made_[kTwoLevel]->counters();
      made_[kTwoLevel].reset();
    }
    provisional_ = false;
  }

  IntegratorSpec spec_;
  std::array<std::unique_ptr<dynamics::LinearSolver>, kNames.size()> made_;
  std::unique_ptr<dynamics::LinearSolver> unsymmetric_;  ///< built at the first unsymmetric matrix
  dynamics::LinearSolver* active_ = nullptr;
  dynamics::MixedPrecisionSolver* mixed_ = nullptr;  ///< this capability of active_, or null
  dynamics::ZeroRowSumMatrix* room_ = nullptr;       ///< step matrix storage of active_
  double allowed_ = 0.0;                             ///< admissible energy-norm error
  std::uint64_t values_version_ = 0;
  int nodes_ = -1;
  std::size_t last_ = kTwoLevel;      ///< solver of symmetric matrices that was active last
  bool provisional_ = false;          ///< active_ is kProvisional, before the first choice
  double stiffness_ = 0.0;            ///< number by which active_ was chosen
  double seen_ = 0.0;                 ///< number of the last matrix if zero-row-sum, else 0
  dynamics::SolverCounters retired_;  ///< counters of the provisional solver once another was chosen
  mutable dynamics::SolverCounters sum_;
};

}  // namespace

std::unique_ptr<dynamics::LinearSolver> make_auto(const IntegratorSpec& spec) {
  check_linear_rtol("auto", spec);
  return std::make_unique<AutoSolver>(spec);
}

}  // namespace palpate::linear
