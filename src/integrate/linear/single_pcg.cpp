#include <algorithm>
#include <cmath>
#include <utility>

#include "integrate/linear/add_counters.h"
#include "integrate/linear/krylov_start.h"
#include "integrate/linear/matrix_age.h"
#include "integrate/linear/single_iteration.h"
#include "integrate/make.h"
#include "integrate/settings.h"
#include "palpate/core/clock.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"

namespace palpate::integrate {
namespace {

using dynamics::BalancedMatrix;
using dynamics::BlockSparse;
using dynamics::BorderedMatrix;
using dynamics::SolveStatus;

constexpr int kIterationLimit = 1000;
/// Single precision keeps a recurrence honest over so much of a reduction; then the residual is computed anew, in double.
constexpr double kReductionInSingle = 1e-4;
/// A solve that asks for no more than this reduction needs no look at the residual in double at its end.
constexpr double kReductionUnchecked = 1e-3;
/// Products of the start are in single precision: what rounding leaves of them, some 1e-7 of the solution in the energy norm, is far below such a tolerance.
constexpr double kTrustsSingleStart = 1e-5;
/// Tighter than rounding of the residual in double is not asked for.
constexpr double kTightest = 1e-13;
constexpr int kResidualReplacements = 40;
/// How well what its age left is solved for.
constexpr double kRoughly = 0.5;
/// Looks at what a matrix near the copy leaves, in one solve.
constexpr int kMostResiduals = 4;
/// Nodes of a cluster, and most clusters: E^-1 is dense, (6 clusters)^2 numbers read in each iteration and (6 clusters)^3 operations a refresh.
constexpr int kNodesOfCluster = 150, kMostClusters = 48;
/// Nodes of its pieces.  The count of iterations hardly changes from 16 to 64, and with pieces it is with 48 clusters what it is with 96 (beams of 32,400 and 99,238 nodes).
constexpr int kNodesOfPiece = 32;
/// Of a number in single precision, relative; and how many tolerances the bound below may come to for a body one element thick.
constexpr double kSingleRounding = 0x1p-24, kRoundingShare = 4.0;
/// Solutions to start from: many for tight tolerances, few for others, where one more saves less in iterations than it costs.
constexpr double kManyStarts = 1e-4;
constexpr int kFewColumns = 3;
/// Nodes of a part, at most: its share of vectors and of the matrix fits a second-level cache, and few pairs of nodes are cut.  Parts come in fours, for threads to share; very
/// small matrices have one.
constexpr int kNodesOfPart = 1536, kNodesOfOnePart = 512;
int parts_of(int nodes) { return nodes <= kNodesOfOnePart ? 1 : 4 * ((nodes + 4 * kNodesOfPart - 1) / (4 * kNodesOfPart)); }

/// Conjugate gradients in single precision on a copy of the matrix (36 bytes a block where double takes 72: an iteration is one reading of it), right in double:
///     r = b - A x            double, by the original matrix
///     A d = r                single: the iteration
///     x += d, and again      until the error is small enough
/// The search goes on across a new residual (the direction is made orthogonal to the last, p . A p_last = 0), so that nothing is lost by it.  Where the tolerance
/// is a modest reduction of what the start left (1e-3), the first r is the last.
///
/// A balanced matrix has no original: its off-diagonal blocks are in single precision from the start (single_matrix.h).  With A~ for A the solution is off by
///     |x~ - x|_A <~ |A^-1/2 (A~ - A) A^-1/2| |x|_A.
/// A~ - A is as indifferent to translations as K, so that of a wave of length l it takes e k (d/l)^2, e = 2^-24, with k the stiffness of a node against its
/// neighbours at the distance d.  A itself takes m + h^2 k (d/l)^2 at least, but where the wave bends a body of thickness t, which to first order turns its parts,
/// m + h^2 k (d/l)^4 (t/d)^2.  The ratio is greatest where both terms are equal, and then
///     e sqrt(s) d/(2 t),   s = 1 + h^2 k/m the stiffness number (auto_solver.cpp);
/// roundings of both signs take off more.  Bodies are several elements thick; one is refused where e sqrt(s) exceeds kRoundingShare tolerances.
///
/// Tolerance: linear_rtol bounds the error of the solution itself, |x - x*|_A <= linear_rtol |x*|_A, by energy_bound.h.  In a step A = M + h D + h^2 K, so
/// the norm is that of the kinetic energy of the velocity change's error plus the elastic energy that its displacement takes; a residual, which peers stop by,
/// bounds it up to the condition number only.
///
/// Start: krylov_start.h.  Preconditioner: inverse 3x3 blocks, in `two-level` with rigid clusters beside them (rigid_clusters.h).  Their E is made anew when what
/// its age cost, in iterations above the fewest since it was made, has reached what a new one costs: counted in operations, not in seconds, so that results do
/// not depend on the machine's mood.
///
/// Results do not depend on the number of threads, bit for bit (cluster_team.h).  They do on the instruction set, by rounding.
///
/// A border (a tool) changes the problem: such matrices are solved by "pcg", whose coarse space is the border.
class SinglePcg final : public dynamics::LinearSolver {
 public:
  SinglePcg(std::string name, bool two_level, const IntegratorSpec& spec)
      : name_(std::move(name)), two_level_(two_level), rtol_(std::max(spec.linear_rtol, kTightest)), spec_(spec), kernels_(node_kernels()), team_(spec.threads),
        copy_(kernels_, team_), start_(kernels_, team_, rtol_ < kManyStarts ? kMostColumns : kFewColumns), iteration_(kernels_, team_, copy_, clusters_) {
    counters::count("integrate.solver." + name_);
  }

  std::string name() const override { return name_; }
  bool supports_unsymmetric() const override { return false; }
  const dynamics::SolverCounters& counters() const override {
    if (!bordered_) return counters_;
    sum_ = counters_;
    add_counters(bordered_->counters(), sum_);
    return sum_;
  }

  SolveStatus factor(const BorderedMatrix& A) override {
    PALPATE_CHECK(A.symmetric, "solver {} was given an unsymmetric matrix", name_);
    delegated_ = A.border_size() > 0 || A.nodal_size() == 0;
    if (delegated_) {
      if (!bordered_) bordered_ = make_pcg(spec_);
      return bordered_->factor(A);
    }
    const bool same_values = matrix_ && copy_.analysed(A.body) && A.values_version != 0 && A.values_version == values_version_;
    matrix_ = &A;
    if (same_values) return status_;
    analyse(A.body);
    values_version_ = A.values_version;
    const ScopedTimer timer(counters_.factor_s);
    ++counters_.factorisations;
    status_ = copy_.take(A, start_.count(), start_.solutions(), start_.products());
    return use_copy(A.positions.size() == A.nodal_size() ? A.positions.data() : nullptr);
  }

  BalancedMatrix* balanced(const BlockSparse& pattern) override {
    if (pattern.block_rows() == 0) return nullptr;
    const bool known = copy_.analysed(pattern);
    if (known && too_coarse_) return nullptr;
    analyse(pattern);
    delegated_ = false;
    matrix_ = nullptr;
    BalancedMatrix& room = copy_.room(pattern);
    room_ = &room;
    return &room;
  }

  SolveStatus factor_balanced() override {
    const ScopedTimer timer(counters_.factor_s);
    ++counters_.factorisations;
    status_ = copy_.take_balanced(start_.count(), start_.solutions(), start_.products());
    too_coarse_ = !(kSingleRounding * std::sqrt(copy_.stiffness()) <= kRoundingShare * rtol_);
    if (status_ == SolveStatus::kOk && too_coarse_) status_ = SolveStatus::kSingular;
    return use_copy(room_->positions);
  }

  SolveStatus solve_near(dynamics::Residual& left, VecX& x) override {
    const bool can = !delegated_ && !matrix_ && status_ == SolveStatus::kOk && start_.count() > 0 && start_.products_followed() && !iteration_.first();
    if (!can || !age_.serves()) return SolveStatus::kNotConverged;
    const double start = wall_seconds();
    residuals_s_ = 0.0;
    x.resize(3 * nodes());
    const SolveStatus status = approach(left, x);
    counters_.solve_s += wall_seconds() - start - residuals_s_;
    if (status != SolveStatus::kOk) {
      age_.failed();
      return status;
    }
    ++counters_.solves;
    ++counters_.near;
    return status;
  }

  SolveStatus solve(const VecX& b, VecX& x) override {
    if (delegated_) return bordered_->solve(b, x);
    check_right_hand_side(b.rows());
    const ScopedTimer timer(counters_.solve_s);
    x.resize(b.size());
    return solve_column(b.data(), x.data(), true);
  }

  SolveStatus solve(const MatX& B, MatX& X) override {
    if (delegated_) return bordered_->solve(B, X);
    check_right_hand_side(B.rows());
    const ScopedTimer timer(counters_.solve_s);
    X.resize(B.rows(), B.cols());
    for (Eigen::Index c = 0; c < B.cols(); ++c)
      if (const SolveStatus status = solve_column(B.col(c).data(), X.col(c).data(), B.cols() == 1); status != SolveStatus::kOk) return status;
    return SolveStatus::kOk;
  }

 private:
  int nodes() const { return copy_.nodes(); }

  // --- once a pattern -------------------------------------------------------------------------------------------------
  void analyse(const BlockSparse& pattern) {
    if (copy_.analysed(pattern)) return;
    const ScopedTimer timer(counters_.symbolic_s);
    ++counters_.symbolic;
    const int n = pattern.block_rows(), clusters = std::min((n + kNodesOfCluster - 1) / kNodesOfCluster, kMostClusters);
    const int parts = two_level_ ? std::min(parts_of(n), clusters) : parts_of(n);
    copy_.analyse(pattern, two_level_ ? clusters : parts, parts, two_level_ ? n / kNodesOfPiece : 0);
    if (two_level_) clusters_.prepare(copy_.order());
    iteration_.prepare();
    start_.prepare(copy_.order());
    largest_.assign(static_cast<std::size_t>(copy_.order().parts()), 0.0);
    for (Doubles* v : {&b_, &x_, &Ax_, &before_}) v->assign(4 * static_cast<std::size_t>(n) + kVectorTail, 0.0);
    too_coarse_ = false;
    age_ = MatrixAge(rtol_);
  }

  // --- once a matrix --------------------------------------------------------------------------------------------------
  SolveStatus use_copy(const double* positions) {
    start_.products_are_known(status_ == SolveStatus::kOk);
    age_.renew();
    if (status_ == SolveStatus::kOk && two_level_ && lost_ >= price_of_clusters()) refresh_clusters(positions);
    return status_;
  }

  /// Operations of a new E and D over those of an iteration.
  double price_of_clusters() const {
    if (!clusters_.ready()) return 0.0;
    const double size = clusters_.size(), blocks = copy_.block_count();
    return (size * size * size + 60.0 * blocks) / (9.0 * blocks + 50.0 * nodes() + size * size);
  }

  void refresh_clusters(const double* positions) {
    clusters_.refresh(copy_, positions, kernels_);
    ++counters_.refreshes;
    lost_ = 0.0;
    fewest_ = HUGE_VAL;
  }

  // --- one right-hand side --------------------------------------------------------------------------------------------
  void check_right_hand_side(Eigen::Index rows) const {
    PALPATE_CHECK(status_ == SolveStatus::kOk, "solver {}: solve without a factor", name_);
    PALPATE_CHECK(!matrix_ || matrix_->values_version == values_version_, "solver {}: the matrix changed between factor and solve", name_);
    PALPATE_CHECK(rows == 3 * nodes(), "right-hand side has {} rows, the matrix {}", rows, 3 * nodes());
  }

  SolveStatus solve_column(const double* b, double* x, bool remember) {
    ++counters_.solves;
    const int* node = copy_.order().node.data();
    team_.for_each([&](std::size_t part, int first, int last) {
      double largest = 0.0;
      for (int k = first; k < last; ++k) {
        const double* from = b + 3 * static_cast<std::ptrdiff_t>(node[k]);
        double* to = b_.data() + 4 * static_cast<std::ptrdiff_t>(k);
        for (int axis = 0; axis < 3; ++axis) {
          to[axis] = from[axis];
          largest = std::max(largest, std::abs(from[axis]));  // of what is no number nothing is said here
        }
      }
      largest_[part] = largest;
    });
    if (*std::max_element(largest_.begin(), largest_.end()) == 0.0 && std::all_of(b_.begin(), b_.end(), [](double value) { return value == 0.0; })) {
      std::fill_n(x, 3 * nodes(), 0.0);
      return SolveStatus::kOk;
    }
    held_.clear();
    for (const std::size_t entry : copy_.held()) held_.push_back(std::exchange(b_[entry], 0.0));
    if (const SolveStatus status = iterate(remember); status != SolveStatus::kOk) return status;
    const double largest = put_solution(x);
    for (std::size_t h = 0; h < held_.size(); ++h) {  // rows of the identity
      const std::size_t entry = copy_.held()[h];
      x[3 * static_cast<std::size_t>(node[entry / 4]) + entry % 4] = held_[h];
    }
    if (remember) {
      follow_product();
      start_.keep(x_, largest, copy_.scale(), Ax_);
    }
    return SolveStatus::kOk;
  }

  /// x_ in the order and shape of its caller; returns its largest number.
  double put_solution(double* x) {
    const int* node = copy_.order().node.data();
    team_.for_each([&](std::size_t part, int first, int last) {
      double largest = 0.0;
      for (int k = first; k < last; ++k) {
        const double* from = x_.data() + 4 * static_cast<std::ptrdiff_t>(k);
        double* to = x + 3 * static_cast<std::ptrdiff_t>(node[k]);
        for (int axis = 0; axis < 3; ++axis) {
          to[axis] = from[axis];
          largest = std::max(largest, std::abs(from[axis]));
        }
      }
      largest_[part] = largest;
    });
    return *std::max_element(largest_.begin(), largest_.end());
  }

  // --- a matrix near the copy -----------------------------------------------------------------------------------------
  // With Ao for the copy and A for what is to be solved, A x = b is Ao x = b - A x + Ao x: where x on the right is an approximation, a system with the copy for a better one,
  // whose error is A^-1 (Ao - A) of the correction (matrix_age.h).  Ao x needs no product: it is the right-hand side less what the iteration left of it.

  SolveStatus approach(dynamics::Residual& left, VecX& x) {
    start_.foresee(copy_.scale(), x_, Ax_);
    int residuals = 1;
    look(left, x);
    const KrylovStart::Start start = start_.combine(true, copy_.scale(), b_, x_, Ax_);
    size_ = start.residual;
    double energy = start.energy, change = start.change, first_correction = 0.0;
    for (;;) {
      if (!std::isfinite(size_)) return SolveStatus::kNotConverged;
      set_residual();
      double open = 0.0;
      if (const SolveStatus status = descend(energy, (1.0 - MatrixAge::kUnseen) * rtol_, open); status != SolveStatus::kOk) return status;
      const double solution = iteration_.solution(), correction = std::sqrt((change + solution - energy) / solution);
      follow_product();
      if (residuals == 1) first_correction = correction;
      if (age_.sure(correction)) break;
      if (residuals == kMostResiduals) return SolveStatus::kNotConverged;
      std::swap(b_, before_);
      look(left, x);
      ++residuals;
      double stale = 0.0;
      if (const SolveStatus status = mend(solution, stale, open); status != SolveStatus::kOk) return status;
      age_.seen(stale, correction);
      if (open <= rtol_) break;
      if (!age_.converges()) return SolveStatus::kNotConverged;
      size_ = norm_of_residual();
      energy = solution;
      change = stale * stale * solution;
    }
    iteration_.end();
    start_.keep(x_, put_solution(x.data()), copy_.scale(), Ax_);
    counters_.residuals += residuals;
    age_.solved(first_correction);
    return SolveStatus::kOk;
  }

  /// b_ = what A leaves of x_, and Ao x_.
  void look(dynamics::Residual& left, VecX& x) {
    put_solution(x.data());
    const double start = wall_seconds();
    left.at(x, residual_);
    residuals_s_ += wall_seconds() - start;
    const int* node = copy_.order().node.data();
    team_.for_each([&](std::size_t, int first, int last) {
      for (int k = first; k < last; ++k) {
        const double* from = residual_.data() + 3 * static_cast<std::ptrdiff_t>(node[k]);
        const std::ptrdiff_t to = 4 * static_cast<std::ptrdiff_t>(k);
        for (std::ptrdiff_t axis = 0; axis < 3; ++axis) b_[static_cast<std::size_t>(to + axis)] = from[axis] + Ax_[static_cast<std::size_t>(to + axis)];
      }
    });
  }

  /// Takes off what the copy's age left: b_ - before_ = (Ao - A) (the last correction), of which a rough solution tells the size and most of itself.
  /// @param stale  its size over the solution's  @param open  in: what the iteration left open; out: with what is left of this
  SolveStatus mend(double solution, double& stale, double& open) {
    double square = 0.0;
    for (std::size_t i = 0; i < b_.size(); ++i) square += (b_[i] - before_[i]) * (b_[i] - before_[i]);
    if (!(square > 0.0)) return square == 0.0 ? SolveStatus::kOk : SolveStatus::kNotConverged;
    size_ = std::sqrt(square);
    const double by = 1.0 / size_;
    team_.for_each([&](std::size_t, int first, int last) { kernels_.residual(by, b_.data(), before_.data(), iteration_.residual().data(), first, last); });
    double rest = 0.0;
    if (const SolveStatus status = descend(0.0, kRoughly, rest); status != SolveStatus::kOk) return status;
    const double found = iteration_.solution();
    stale = std::sqrt(found * (1.0 + rest * rest) / solution);
    open += rest * std::sqrt(found / solution);
    const float* r = iteration_.residual().data();
    team_.for_each([&](std::size_t, int first, int last) {
      for (std::size_t k = 4 * static_cast<std::size_t>(first); k < 4 * static_cast<std::size_t>(last); ++k) Ax_[k] += b_[k] - before_[k] - size_ * static_cast<double>(r[k]);
    });
    return SolveStatus::kOk;
  }

  /// Iterates from the iteration's residual, of that size, until the error is below rtol of the solution, or single precision has no more to say.
  /// @param start  as EnergyBound::begin  @param open  the error then, over the solution
  SolveStatus descend(double start, double rtol, double& open) {
    iteration_.begin(start);
    iteration_.set_floor(HUGE_VAL);
    iteration_.forget_direction();
    iteration_.clear_correction();
    double rho = iteration_.precondition();
    if (!std::isfinite(rho)) return SolveStatus::kNotConverged;
    if (!iteration_.reached(rho * unit(), rtol)) {
      int steps = 0;
      const SolveStatus status = iteration_.reduce(rho, 0.0, kReductionInSingle * kReductionInSingle * rho, unit(), rtol, kIterationLimit, steps);
      counters_.iterations += steps;
      if (status != SolveStatus::kOk) return status;
      add_correction();
    }
    open = std::sqrt(iteration_.error(rho * unit()) / iteration_.solution());
    return SolveStatus::kOk;
  }

  /// Ax_ of what the iteration came to.
  void follow_product() {
    const float* r = iteration_.residual().data();
    team_.for_each([&](std::size_t, int first, int last) {
      for (std::size_t k = 4 * static_cast<std::size_t>(first); k < 4 * static_cast<std::size_t>(last); ++k) Ax_[k] = b_[k] - size_ * static_cast<double>(r[k]);
    });
  }

  SolveStatus iterate(bool warm) {
    if (warm && start_.count() > 0 && !start_.products_known()) {
      copy_.multiply(start_.count(), start_.solutions(), start_.products());
      start_.products_are_known(true);
    }
    const KrylovStart::Start start = start_.combine(warm, copy_.scale(), b_, x_, Ax_);
    size_ = start.residual;
    if (!std::isfinite(size_)) return SolveStatus::kNotConverged;
    if (size_ == 0.0) return SolveStatus::kOk;
    set_residual();
    iteration_.begin(start.energy);
    const long before = counters_.iterations;
    if (const SolveStatus status = refine(); status != SolveStatus::kOk) return status;
    iteration_.end();
    age_.solved(std::sqrt((start.change + iteration_.solution() - start.energy) / iteration_.solution()));
    account(static_cast<double>(counters_.iterations - before));
    return SolveStatus::kOk;
  }

  /// What the age of E costs, for the decision in use_copy().
  void account(double iterations) {
    if (!two_level_) return;
    fewest_ = std::min(fewest_, iterations);
    lost_ += iterations - fewest_;
  }

  /// r = (b - A x) / size in single precision, with Ax_ at hand; size, so that r is of order one.
  void set_residual() {
    const double by = 1.0 / size_;
    team_.for_each([&](std::size_t, int first, int last) { kernels_.residual(by, b_.data(), Ax_.data(), iteration_.residual().data(), first, last); });
  }
  double norm_of_residual() const {
    double square = 0.0;
    for (std::size_t i = 0; i < b_.size(); ++i) square += (b_[i] - Ax_[i]) * (b_[i] - Ax_[i]);
    return std::sqrt(square);
  }

  /// Energies of the copy's problem (A scale) d = (b - A x)/size in units of the matrix's own: |x|_A^2 = scale size^2 |d|^2.
  double unit() const { return copy_.scale() * size_ * size_; }

  SolveStatus refine() {
    double rho = iteration_.precondition();
    // Of a first solve the spectrum is not known: the residual's own norm goes ten times below what is asked.
    iteration_.set_floor(iteration_.first() ? 0.01 * rtol_ * rtol_ * rho * unit() : HUGE_VAL);
    const double unchecked = iteration_.first() ? HUGE_VAL : kReductionUnchecked * kReductionUnchecked * rho * unit();
    iteration_.forget_direction();
    iteration_.clear_correction();
    double conjugate = 0.0;
    int left = kIterationLimit;
    for (int replacement = 0; replacement < kResidualReplacements; ++replacement) {
      if (!std::isfinite(rho)) return SolveStatus::kNotConverged;
      if (iteration_.reached(rho * unit(), rtol_)) return SolveStatus::kOk;
      int steps = 0;
      const SolveStatus status = iteration_.reduce(rho, conjugate, kReductionInSingle * kReductionInSingle * rho, unit(), rtol_, left, steps);
      left -= steps;
      counters_.iterations += steps;
      if (status != SolveStatus::kOk) return status;
      const bool done = iteration_.reached(rho * unit(), rtol_);
      const double size_before = size_;
      add_correction();
      if (done && replacement == 0 && rho * unit() >= unchecked && rtol_ >= kTrustsSingleStart) return SolveStatus::kOk;
      copy_.multiply(x_, Ax_);
      ++counters_.iterations;
      size_ = norm_of_residual();
      if (size_ == 0.0) return SolveStatus::kOk;
      set_residual();
      const bool moved = iteration_.minimise_along_last();
      rho = iteration_.precondition();
      if (iteration_.reached(rho * unit(), rtol_)) {
        if (moved) add_correction();
        return SolveStatus::kOk;
      }
      if (size_ > 0.5 * size_before && replacement > 0) return at_rounding() ? SolveStatus::kOk : SolveStatus::kNotConverged;
      conjugate = iteration_.orthogonal_to_last();
    }
    return SolveStatus::kNotConverged;
  }

  /// No digit more can be had: the residual is what rounding of its own terms leaves.
  bool at_rounding() const { return size_ <= 1e-14 * (norm(b_) + norm(x_) / copy_.scale()); }
  static double norm(const Doubles& v) { return Eigen::Map<const VecX>(v.data(), static_cast<Eigen::Index>(v.size())).norm(); }

  void add_correction() {
    const double by = copy_.scale() * size_;
    team_.for_each([&](std::size_t, int first, int last) { kernels_.correct(by, iteration_.correction().data(), x_.data(), first, last); });
    iteration_.clear_correction();
  }

  std::string name_;
  bool two_level_;
  double rtol_;
  IntegratorSpec spec_;
  const NodeKernels& kernels_;
  ClusterTeam team_;
  dynamics::SolverCounters counters_;
  mutable dynamics::SolverCounters sum_;
  std::unique_ptr<dynamics::LinearSolver> bordered_;  ///< made at the first matrix with a border
  bool delegated_ = false;

  const BorderedMatrix* matrix_ = nullptr;  ///< last given to factor(); null: a balanced one
  const BalancedMatrix* room_ = nullptr;
  bool too_coarse_ = false;                 ///< for the tolerance: the last balanced matrix of this pattern
  std::uint64_t values_version_ = 0;
  SolveStatus status_ = SolveStatus::kSingular;
  SingleMatrix copy_;
  RigidClusters clusters_;                 ///< ready in `two-level` alone
  double lost_ = 0.0, fewest_ = HUGE_VAL;  ///< since E was made: iterations above the fewest, and these
  KrylovStart start_;
  SingleIteration iteration_;
  Doubles b_, x_, Ax_, before_;
  VecX residual_;
  double residuals_s_ = 0.0;
  MatrixAge age_{rtol_};                      ///< of a balanced matrix, which is kept from step to step
  std::vector<double> largest_, held_;  ///< of b: of each part; where it stands alone
  double size_ = 0.0;
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

}  // namespace palpate::integrate
