#include <algorithm>
#include <cmath>

#include "integrate/linear/add_counters.h"
#include "integrate/linear/energy_bound.h"
#include "integrate/linear/node_kernels.h"
#include "integrate/linear/node_order.h"
#include "integrate/linear/rigid_clusters.h"
#include "integrate/make.h"
#include "integrate/settings.h"
#include "palpate/core/clock.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/core/huge_pages.h"
#include "palpate/core/team.h"

namespace palpate::integrate {
namespace {

using dynamics::BorderedMatrix;
using dynamics::SolveStatus;

/// Vectors over the nodes, four numbers a node (node_kernels.h).
using Singles = std::vector<float>;
using Doubles = std::vector<double>;

constexpr int kIterationLimit = 1000;
/// Single precision keeps a recurrence honest over so much of a reduction; then the residual is computed anew, in double.
constexpr double kReductionInSingle = 1e-4;
/// A solve that asks for no more than this reduction needs no look at the residual in double at its end.
constexpr double kReductionUnchecked = 1e-3;
/// Tighter than rounding of the residual in double is not asked for.
constexpr double kTightest = 1e-13;
constexpr int kResidualReplacements = 40;
/// Nodes of a cluster, and most clusters: E^-1 is dense, (6 clusters)^2 numbers read in each iteration and (6 clusters)^3 operations a refresh.
constexpr int kNodesOfCluster = 100, kMostClusters = 96;
/// Of a cluster that is a chunk of work and no more.
constexpr int kNodesOfChunk = 200;

/// Conjugate gradients in single precision on a copy of the matrix (36 bytes a block where double takes 72: an iteration is one reading of it), right in double:
///     r = b - A x            double, by the original matrix
///     A d = r                single: the iteration
///     x += d, and again      until the error is small enough
/// The search goes on across a new residual (the direction is made orthogonal to the last, p . A p_last = 0), so that nothing is lost by it.  Where the tolerance
/// is a modest reduction of what the start left (1e-3), the first r is the last.
///
/// Tolerance: linear_rtol bounds the error of the solution itself, |x - x*|_A <= linear_rtol |x*|_A, by energy_bound.h.  In a step A = M + h D + h^2 K, so
/// the norm is that of the kinetic energy of the velocity change's error plus the elastic energy that its displacement takes; a residual, which peers stop by,
/// bounds it up to the condition number only.
///
/// Start: the best combination of the last three solutions in the energy norm, y of V^T A V y = V^T b (Fischer 1998).  V is known before the matrix is:
/// A V is formed in double while the matrix is copied, in the same reading.
///
/// Preconditioner: inverse 3x3 blocks, in `two-level` with rigid clusters beside them (rigid_clusters.h).  Their E is made anew when what its age cost, in
/// iterations above the fewest since it was made, has reached what a new one costs: counted in operations, not in seconds, so that results do not depend on the machine's mood.
///
/// Threads: all sums go over clusters, in their order: results do not depend on the number of threads, bit for bit.  They do on the instruction set, by rounding.
///
/// A border (a tool) changes the problem: such matrices are solved by "pcg", whose coarse space is the border.
class SinglePcg final : public dynamics::LinearSolver {
 public:
  SinglePcg(std::string name, bool two_level, const IntegratorSpec& spec)
      : name_(std::move(name)), two_level_(two_level), rtol_(std::max(spec.linear_rtol, kTightest)), spec_(spec), kernels_(node_kernels()), team_(spec.threads) {
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
    const bool same_pattern = matrix_ && A.body.pattern_version() == pattern_version_ && A.body.block_rows() == nodes_;
    matrix_ = &A;
    if (same_pattern && A.values_version != 0 && A.values_version == values_version_) return status_;
    if (!same_pattern) analyse(A.body);
    pattern_version_ = A.body.pattern_version();
    values_version_ = A.values_version;
    const ScopedTimer timer(counters_.factor_s);
    ++counters_.factorisations;
    return status_ = take_values();
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
  // --- once a pattern -------------------------------------------------------------------------------------------------
  void analyse(const dynamics::BlockSparse& A) {
    const ScopedTimer timer(counters_.symbolic_s);
    ++counters_.symbolic;
    nodes_ = A.block_rows();
    const int per_cluster = two_level_ ? kNodesOfCluster : kNodesOfChunk;
    const int clusters = (nodes_ + per_cluster - 1) / per_cluster;
    order_ = cluster_nodes(A, two_level_ ? std::min(clusters, kMostClusters) : clusters);
    const auto n = static_cast<std::size_t>(nodes_);
    std::vector<int> place(n);
    for (std::size_t k = 0; k < n; ++k) place[static_cast<std::size_t>(order_.node[k])] = static_cast<int>(k);
    row_start_.assign(1, 0);
    column_.clear();
    source_.clear();
    diagonal_.resize(n);
    std::vector<std::pair<int, int>> row;
    for (const int i : order_.node) {
      row.clear();
      for (int s = A.row_start()[static_cast<std::size_t>(i)]; s < A.row_start()[static_cast<std::size_t>(i) + 1]; ++s)
        row.emplace_back(place[static_cast<std::size_t>(A.columns()[static_cast<std::size_t>(s)])], s);
      std::sort(row.begin(), row.end());
      for (const auto& [column, slot] : row) {
        column_.push_back(column);
        source_.push_back(slot);
        if (column == place[static_cast<std::size_t>(i)]) diagonal_[static_cast<std::size_t>(column)] = slot;
      }
      row_start_.push_back(static_cast<int>(column_.size()));
    }
    values_.assign(9 * column_.size() + kBlockTail, 0.0f);
    prefer_huge_pages(values_);
    prefer_huge_pages(column_);
    prefer_huge_pages(source_);
    inverse_.assign(kInverseStride * n + kVectorTail, 0.0f);
    for (Singles* v : {&d_, &r_, &z_, &p_, &q_}) v->assign(4 * n + kVectorTail, 0.0f);
    for (Doubles* v : {&b_, &x_, &Ax_}) v->assign(4 * n + kVectorTail, 0.0);
    for (int k = 0; k < kMostColumns; ++k) {
      V_[k].assign(4 * n + kVectorTail, 0.0);
      AV_[k].assign(4 * n + kVectorTail, 0.0);
    }
    remembered_ = 0;
    bounds_.assign(static_cast<std::size_t>(team_.size()), {});
    const auto c = static_cast<std::size_t>(order_.clusters());
    partial_.assign(c, 0.0);
    partial_rz_.assign(c, 0.0);
    good_.assign(c, 0);
    share_work();
    if (!two_level_) return;
    clusters_.prepare(order_);
    y_.assign(static_cast<std::size_t>(clusters_.stride()), 0.0f);
    w_.assign(static_cast<std::size_t>(clusters_.stride()), 0.0f);
  }

  /// Which clusters each thread works on: equal numbers of blocks, as near as clusters allow.
  void share_work() {
    const int threads = team_.size();
    mine_.assign(static_cast<std::size_t>(threads) + 1, 0);
    int cluster = 0;
    for (int t = 1; t <= threads; ++t) {
      const long goal = static_cast<long>(column_.size()) * t / threads;
      while (cluster < order_.clusters() && row_start_[static_cast<std::size_t>(order_.start[static_cast<std::size_t>(cluster) + 1])] <= goal) ++cluster;
      mine_[static_cast<std::size_t>(t)] = t == threads ? order_.clusters() : cluster;
    }
  }

  /// work(cluster, first node, last node) over the clusters of thread t
  template <class Work>
  void over_clusters(int t, Work&& work) const {
    for (int c = mine_[static_cast<std::size_t>(t)]; c < mine_[static_cast<std::size_t>(t) + 1]; ++c)
      work(static_cast<std::size_t>(c), order_.start[static_cast<std::size_t>(c)], order_.start[static_cast<std::size_t>(c) + 1]);
  }
  static double sum_of(const std::vector<double>& parts) {
    double sum = 0.0;
    for (const double part : parts) sum += part;
    return sum;
  }

  // --- once a matrix --------------------------------------------------------------------------------------------------
  DoubleBlocks original() const {
    return {row_start_.data(), column_.data(), source_.data(), matrix_->body.values().data(), static_cast<int>(column_.size()) - 1};
  }
  SingleBlocks copy() const { return {row_start_.data(), column_.data(), values_.data()}; }

  SolveStatus take_values() {
    const double* values = matrix_->body.values().data();
    // A power of two near 1/(mean of the diagonal): single precision overflows where double does not.
    double mean = 0.0;
    for (const int slot : diagonal_) mean += values[9 * static_cast<std::size_t>(slot)] / nodes_;
    if (!std::isfinite(mean)) return SolveStatus::kSingular;
    if (!(mean > 0.0)) return SolveStatus::kIndefinite;
    scale_ = std::ldexp(1.0, -std::ilogb(mean));
    multiply(remembered_, V_, AV_, values_.data());
    AV_version_ = values_version_;
    if (std::find(good_.begin(), good_.end(), char{0}) != good_.end()) return SolveStatus::kSingular;
    team_.run([&](int t) {
      over_clusters(t, [&](std::size_t c, int first, int last) {
        good_[c] = kernels_.invert_diagonal(values, diagonal_.data(), scale_, inverse_.data(), first, last);
      });
    });
    if (std::find(good_.begin(), good_.end(), char{0}) != good_.end()) return SolveStatus::kIndefinite;
    if (two_level_ && lost_ >= price_of_clusters()) refresh_clusters();
    return SolveStatus::kOk;
  }

  /// to = A from in double for `count` columns, and the copy where `out` is given
  void multiply(int count, const Doubles* from, Doubles* to, float* out) {
    const double* V[kMostColumns] = {};
    double* AV[kMostColumns] = {};
    for (int k = 0; k < count; ++k) {
      V[k] = from[k].data();
      AV[k] = to[k].data();
    }
    team_.run([&](int t) {
      over_clusters(t, [&](std::size_t c, int first, int last) {
        good_[c] = kernels_.convert(original(), scale_, out, count, V, AV, first, last);
      });
    });
  }

  /// Operations of a new E over those of an iteration.
  double price_of_clusters() const {
    if (!clusters_.ready()) return 0.0;
    const double size = clusters_.size(), blocks = static_cast<double>(column_.size());
    return (size * size * size + 40.0 * blocks) / (9.0 * blocks + 40.0 * nodes_ + size * size);
  }

  void refresh_clusters() {
    clusters_.refresh(copy(), order_, matrix_->positions, kernels_);
    ++counters_.refreshes;
    lost_ = 0.0;
    fewest_ = HUGE_VAL;
  }

  // --- one right-hand side --------------------------------------------------------------------------------------------
  void check_right_hand_side(Eigen::Index rows) const {
    PALPATE_CHECK(status_ == SolveStatus::kOk, "solver {}: solve without a factor", name_);
    PALPATE_CHECK(matrix_->values_version == values_version_, "solver {}: the matrix changed between factor and solve", name_);
    PALPATE_CHECK(rows == 3 * nodes_, "right-hand side has {} rows, the matrix {}", rows, 3 * nodes_);
  }

  double dot(const Doubles& a, const Doubles& b) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < 4 * static_cast<std::size_t>(nodes_); i += 4) sum += a[i] * b[i] + a[i + 1] * b[i + 1] + a[i + 2] * b[i + 2];
    return sum;
  }

  SolveStatus solve_column(const double* b, double* x, bool remember) {
    ++counters_.solves;
    bool zero = true;
    for (std::size_t k = 0; k < order_.node.size(); ++k)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double value = b[3 * static_cast<std::size_t>(order_.node[k]) + axis];
        zero = zero && value == 0.0;
        b_[4 * k + axis] = value;
      }
    std::fill(x_.begin(), x_.end(), 0.0);
    const SolveStatus status = zero ? SolveStatus::kOk : iterate(remember);
    if (status != SolveStatus::kOk) return status;
    for (std::size_t k = 0; k < order_.node.size(); ++k)
      for (std::size_t axis = 0; axis < 3; ++axis) x[3 * static_cast<std::size_t>(order_.node[k]) + axis] = x_[4 * k + axis];
    if (remember && !zero) keep_solution();
    return status;
  }

  void keep_solution() {
    for (int k = kMostColumns - 1; k > 0; --k) V_[k].swap(V_[k - 1]);
    V_[0] = x_;
    remembered_ = std::min(remembered_ + 1, kMostColumns);
    AV_version_ = 0;
  }

  /// x = V y, r = b - A x.  By Cholesky, column by column; a solution that lies in the span of newer ones gives nothing new and is left out.
  /// @return |x|_A^2
  double start_from_last() {
    double L[kMostColumns][kMostColumns] = {}, c[kMostColumns] = {}, y[kMostColumns] = {};
    bool used[kMostColumns] = {};
    double energy = 0.0;
    for (int j = 0; j < remembered_; ++j) {
      const double own = dot(V_[j], AV_[j]);
      double pivot = own;
      for (int i = 0; i < j; ++i) {
        if (!used[i]) continue;
        double s = dot(V_[j], AV_[i]);
        for (int k = 0; k < i; ++k) s -= L[j][k] * L[i][k];
        L[j][i] = s / L[i][i];
        pivot -= L[j][i] * L[j][i];
      }
      if (!(pivot > 1e-10 * own)) continue;
      used[j] = true;
      L[j][j] = std::sqrt(pivot);
      c[j] = dot(V_[j], b_);
      for (int k = 0; k < j; ++k) c[j] -= L[j][k] * c[k];
      c[j] /= L[j][j];
      energy += c[j] * c[j];
    }
    for (int j = remembered_ - 1; j >= 0; --j) {
      if (!used[j]) continue;
      y[j] = c[j];
      for (int i = j + 1; i < remembered_; ++i) y[j] -= L[i][j] * y[i];
      y[j] /= L[j][j];
    }
    const auto entries = 4 * static_cast<std::size_t>(nodes_);
    std::fill(Ax_.begin(), Ax_.end(), 0.0);
    for (int j = 0; j < remembered_; ++j) {
      if (!used[j]) continue;
      const double *v = V_[j].data(), *Av = AV_[j].data();
      for (std::size_t i = 0; i < entries; ++i) {
        x_[i] += y[j] * v[i];
        Ax_[i] += y[j] * Av[i];
      }
    }
    return energy;
  }

  /// r = (b - A x) / size with Ax_ at hand, in single precision; size: so that r is of order one.
  void set_residual() {
    double square = 0.0;
    const auto entries = 4 * static_cast<std::size_t>(nodes_);
    for (std::size_t i = 0; i < entries; ++i) square += (b_[i] - Ax_[i]) * (b_[i] - Ax_[i]);
    size_ = std::sqrt(square);
    const double by = size_ > 0.0 ? 1.0 / size_ : 0.0;
    for (std::size_t i = 0; i < entries; ++i) r_[i] = static_cast<float>(by * (b_[i] - Ax_[i]));
  }

  /// z = J r and, with clusters, w = E^-1 Z^T r; returns r . P^-1 r.  Of the copy: A/scale, so everything in single precision is in its units.
  double precondition() {
    team_.run([&](int t) {
      over_clusters(t, [&](std::size_t c, int first, int last) { partial_[c] = jacobi_of(c, first, last); });
      team_.barrier();
      coarse(t);
    });
    return sum_of(partial_) + coarse_share();
  }
  double jacobi_of(std::size_t c, int first, int last) {
    if (coarse_on()) kernels_.gather_rigid(r_.data(), clusters_.arm(), y_.data() + 6 * c, first, last);
    return kernels_.jacobi(inverse_.data(), r_.data(), z_.data(), first, last);
  }
  bool coarse_on() const { return two_level_ && clusters_.ready(); }
  void coarse(int t) {
    if (!coarse_on()) return;
    const int size = clusters_.size(), threads = team_.size();
    kernels_.dense(clusters_.inverse(), clusters_.stride(), y_.data(), w_.data(), size * t / threads, size * (t + 1) / threads);
  }
  double coarse_share() const {
    double sum = 0.0;
    if (coarse_on())
      for (std::size_t k = 0; k < w_.size(); ++k) sum += static_cast<double>(y_[k]) * w_[k];
    return sum;
  }
  const float* motion(std::size_t c) const { return coarse_on() ? w_.data() + 6 * c : nullptr; }

  SolveStatus iterate(bool warm) {
    double energy = 0.0;
    if (warm && remembered_ > 0) {
      if (AV_version_ != values_version_) multiply(remembered_, V_, AV_, nullptr);
      energy = start_from_last();
    } else {
      std::fill(Ax_.begin(), Ax_.end(), 0.0);
    }
    set_residual();
    if (!std::isfinite(size_)) return SolveStatus::kNotConverged;
    if (size_ == 0.0) return SolveStatus::kOk;
    for (EnergyBound& bound : bounds_) bound.begin(energy);
    const long before = counters_.iterations;
    const SolveStatus status = refine();
    if (status != SolveStatus::kOk) return status;
    for (EnergyBound& bound : bounds_) bound.end();
    account(static_cast<double>(counters_.iterations - before));
    return status;
  }

  /// What the age of E costs, for the decision in take_values().
  void account(double iterations) {
    if (!two_level_) return;
    fewest_ = std::min(fewest_, iterations);
    lost_ += iterations - fewest_;
  }

  /// Energies of the copy's problem (A scale) d = (b - A x)/size in units of the matrix's own: |x|_A^2 = scale size^2 |d|^2.
  double unit() const { return scale_ * size_ * size_; }
  bool reached(const EnergyBound& bound, double rho) const { return bound.error(rho) <= rtol_ * rtol_ * bound.solution() && rho <= floor_; }

  SolveStatus refine() {
    double rho = precondition();
    // Of a first solve the spectrum is not known: the residual's own norm goes ten times below what is asked.
    floor_ = bounds_[0].first() ? 0.01 * rtol_ * rtol_ * rho * unit() : HUGE_VAL;
    const double unchecked = bounds_[0].first() ? HUGE_VAL : kReductionUnchecked * kReductionUnchecked * rho * unit();
    std::fill(p_.begin(), p_.end(), 0.0f);
    std::fill(d_.begin(), d_.end(), 0.0f);
    double conjugate = 0.0;
    left_ = kIterationLimit;
    for (int replacement = 0; replacement < kResidualReplacements; ++replacement) {
      if (!std::isfinite(rho)) return SolveStatus::kNotConverged;
      if (reached(bounds_[0], rho * unit())) return SolveStatus::kOk;
      double rho_end = rho;
      if (const SolveStatus status = reduce(rho_end, conjugate); status != SolveStatus::kOk) return status;
      const bool done = reached(bounds_[0], rho_end * unit());
      const double size_before = size_;
      add_correction();
      if (done && replacement == 0 && rho_end * unit() >= unchecked) return SolveStatus::kOk;
      const Doubles* const x = &x_;
      multiply(1, x, &Ax_, nullptr);
      ++counters_.iterations;
      set_residual();
      if (size_ == 0.0) return SolveStatus::kOk;
      const bool moved = minimise_along_last();
      rho = precondition();
      if (reached(bounds_[0], rho * unit())) {
        if (moved) add_correction();
        return SolveStatus::kOk;
      }
      if (size_ > 0.5 * size_before && replacement > 0) return at_rounding() ? SolveStatus::kOk : SolveStatus::kNotConverged;
      conjugate = orthogonal_to_last();
    }
    return SolveStatus::kNotConverged;
  }

  /// No digit more can be had: the residual is what rounding of its own terms leaves.
  bool at_rounding() const { return size_ <= 1e-14 * (std::sqrt(dot(b_, b_)) + std::sqrt(dot(x_, x_)) / scale_); }

  void add_correction() {
    const double by = scale_ * size_;
    for (std::size_t i = 0; i < 4 * static_cast<std::size_t>(nodes_); ++i) x_[i] += by * static_cast<double>(d_[i]);
    std::fill(d_.begin(), d_.end(), 0.0f);
  }

  /// What rounding left in a new residual is not orthogonal to the last direction, on which the length of the next step relies: the least error along it makes it so.
  bool minimise_along_last() {
    if (!(pq_ > 0.0)) return false;
    const auto entries = 4 * static_cast<std::size_t>(nodes_);
    double rp = 0.0;
    for (std::size_t i = 0; i < entries; ++i) rp += static_cast<double>(r_[i]) * p_[i];
    const auto a = static_cast<float>(rp / pq_);
    for (std::size_t i = 0; i < entries; ++i) {
      d_[i] += a * p_[i];
      r_[i] -= a * q_[i];
    }
    return true;
  }

  /// The whole of P^-1 r into z, and the share of the last direction that makes the next one orthogonal to it: beta = -(z . A p)/(p . A p).
  double orthogonal_to_last() {
    double zq = 0.0;
    for (int c = 0; c < order_.clusters(); ++c) {
      const int first = order_.start[static_cast<std::size_t>(c)], last = order_.start[static_cast<std::size_t>(c) + 1];
      if (coarse_on()) kernels_.direction(0.0f, z_.data(), clusters_.arm(), motion(static_cast<std::size_t>(c)), z_.data(), first, last);
      for (std::size_t i = 4 * static_cast<std::size_t>(first); i < 4 * static_cast<std::size_t>(last); ++i) zq += static_cast<double>(z_[i]) * q_[i];
    }
    std::fill(w_.begin(), w_.end(), 0.0f);  // is in z now
    return pq_ > 0.0 ? -zq / pq_ : 0.0;
  }

  /// From the residual and z = P^-1 r on, until the bound is reached or single precision is spent.
  SolveStatus reduce(double& rho_in_out, double beta) {
    const double spent = kReductionInSingle * kReductionInSingle * rho_in_out, in_units = unit();
    const SingleBlocks A = copy();
    SolveStatus status = SolveStatus::kOk;
    int steps = 0;
    double rho_end = rho_in_out;
    team_.run([&](int t) {
      EnergyBound& bound = bounds_[static_cast<std::size_t>(t)];
      double rho = rho_in_out, b = beta;
      for (int k = 1;; ++k) {
        over_clusters(t, [&](std::size_t c, int first, int last) {
          kernels_.direction(static_cast<float>(b), z_.data(), clusters_.arm(), motion(c), p_.data(), first, last);
        });
        team_.barrier();
        over_clusters(t, [&](std::size_t c, int first, int last) { partial_[c] = kernels_.product(A, p_.data(), q_.data(), first, last); });
        team_.barrier();
        const double pq = sum_of(partial_);
        const bool bad = !(pq > 0.0) || !std::isfinite(pq);
        if (!bad) {
          const auto alpha = static_cast<float>(rho / pq);
          over_clusters(t, [&](std::size_t c, int first, int last) {
            partial_rz_[c] = kernels_.update(alpha, p_.data(), q_.data(), inverse_.data(), d_.data(), r_.data(), z_.data(), first, last);
            if (coarse_on()) kernels_.gather_rigid(r_.data(), clusters_.arm(), y_.data() + 6 * c, first, last);
          });
          team_.barrier();
          coarse(t);
          if (coarse_on()) team_.barrier();
          const double next = sum_of(partial_rz_) + coarse_share();
          bound.step(rho / pq, rho * in_units, next * in_units);
          b = next / rho;
          rho = next;
        }
        const bool end = bad || !std::isfinite(rho) || reached(bound, rho * in_units) || rho <= spent || k >= left_;
        if (!end) continue;
        if (t == 0) {
          steps = k;
          rho_end = rho;
          pq_ = pq;
          if (bad) status = pq <= 0.0 ? SolveStatus::kIndefinite : SolveStatus::kNotConverged;
          else if (!std::isfinite(rho) || (k >= left_ && !reached(bound, rho * in_units))) status = SolveStatus::kNotConverged;
        }
        return;
      }
    });
    left_ -= steps;
    counters_.iterations += steps;
    rho_in_out = rho_end;
    return status;
  }

  std::string name_;
  bool two_level_;
  double rtol_;
  IntegratorSpec spec_;
  const NodeKernels& kernels_;
  Team team_;
  dynamics::SolverCounters counters_;
  mutable dynamics::SolverCounters sum_;
  std::unique_ptr<dynamics::LinearSolver> bordered_;  ///< made at the first matrix with a border
  bool delegated_ = false;

  const BorderedMatrix* matrix_ = nullptr;  ///< last given to factor()
  std::uint64_t pattern_version_ = 0, values_version_ = 0, AV_version_ = 0;
  int nodes_ = 0;
  SolveStatus status_ = SolveStatus::kSingular;
  NodeOrder order_;
  std::vector<int> row_start_, column_, source_, diagonal_;  ///< in the order's numbering; source, diagonal: slots of the original
  std::vector<int> mine_;                                    ///< first cluster of each thread
  Singles values_, inverse_;                                 ///< the copy's blocks; inverses of its diagonal
  double scale_ = 1.0;                                       ///< copy = scale A
  RigidClusters clusters_;
  double lost_ = 0.0, fewest_ = HUGE_VAL;  ///< since E was made: iterations above the fewest, and these

  Doubles V_[kMostColumns], AV_[kMostColumns];  ///< last solutions, the newest first
  int remembered_ = 0;
  Doubles b_, x_, Ax_;
  Singles d_, r_, z_, p_, q_, y_, w_;
  double size_ = 0.0, floor_ = 0.0, pq_ = 0.0;
  int left_ = 0;
  std::vector<EnergyBound> bounds_;  ///< one a thread, all alike: each decides for itself, with nothing to wait for
  std::vector<double> partial_, partial_rz_;
  std::vector<char> good_;
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
