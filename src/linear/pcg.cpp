#include <cmath>

#include "core/clock.h"
#include "core/counters.h"
#include "core/finite.h"
#include "linear/make.h"
#include "linear/settings.h"
#include "palpate/core/error.h"

namespace palpate::linear {
namespace {

using dynamics::BorderedMatrix;
using dynamics::SolveStatus;

/// A new CHOLMOD factor and its solve cost about as much as 400 products (one measured run each at 3,700 and
/// 11,172 nodes of a beam); an iteration far beyond that is not worthwhile.
constexpr int kIterationLimit = 1000;
/// The recurrence's residual drifts from b - A x by rounding; it is replaced by the true residual this many
/// times before the tolerance counts as out of reach.
constexpr int kResidualReplacements = 3;
/// Solves for the coarse space W: relative residual, and most products per column.
constexpr double kCoarseTolerance = 0.1;
constexpr int kCoarseLimit = 10;

/// Preconditioned conjugate gradients (Hestenes and Stiefel 1952). The preconditioner of
///     A = [ B  R ]   nodes                    P^-1 = [ J^-1  0 ] + Z E^-1 Z^T,     Z = [ W ],   E = Z^T A Z
///         [ R' C ]   border (a tool)                 [ 0     0 ]                       [ I ]
/// is block Jacobi on the nodes, J the 3x3 diagonal blocks of B, plus a coarse space: each direction of the
/// border with the nodes' displacement response W to it. With W = -B^-1 R, E is the border's Schur
/// complement, and P^-1 A has the spectrum of J^-1 B and ones: a tool costs no iteration, however stiff its
/// contacts are. With the corner C alone (W = 0) the soft directions in which nodes and tool move together
/// would be treated as being as stiff as the contact. So W is computed by conjugate gradients on B, from the
/// last W, to a relative residual of a tenth only: the Galerkin matrix E is positive definite at any W where
/// A is.
///
/// Warm start: x0 = a y with y the last solution of the same column and a = (y . b) / (y . A y), the
/// minimum of the error's A-norm along y; never worse than zero.
///
/// Stopping criterion: |r| <= rtol |b| in the Euclidean norm, and |r|_{P^-1} <= rtol |b|_{P^-1}, which is
/// invariant under the choice of units (forces and moments share one vector). Both are checked again with the
/// true residual b - A x. The second implies for the error e and the condition number kappa of P^-1 A
///     |e|_A <= rtol sqrt(kappa) |x|_A.
/// Where rounding alone is larger, eps |A| |x| > rtol |b|, no solver reaches the tolerance: kNotConverged.
///
/// SUNDIALS uses this as a direct solver: it takes Newton's corrections d as exact and estimates the
/// convergence rate from their norms, fails at a rate of 2, and accepts a correction below 0.1 of the error
/// test's tolerance at once. An error of rtol sqrt(kappa) |d| adds at most that much to the rate. With kappa
/// < 1e10 the default of 1e-8 keeps it below 1e-3, which SUNDIALS cannot detect.
///
/// A direction of negative curvature, p . A p <= 0, proves A indefinite: in factor() for a block, in solve()
/// for a search direction. Counters: one factorisation per preconditioner; one iteration per product with A,
/// including those of the coarse space and of the final check.
class Pcg final : public dynamics::LinearSolver {
 public:
  explicit Pcg(double rtol) : rtol_(rtol) { counters::count("integrate.solver.pcg"); }

  std::string name() const override { return "pcg"; }
  bool supports_unsymmetric() const override { return false; }
  const dynamics::SolverCounters& counters() const override { return counters_; }

  SolveStatus factor(const BorderedMatrix& A) override {
    PALPATE_CHECK(A.symmetric, "solver pcg was given an unsymmetric matrix");
    const bool same_pattern =
        matrix_ && A.body.pattern_version() == pattern_version_ && A.nodal_size() == nodal_;
    const bool same_values = same_pattern && A.values_version != 0 && A.values_version == values_version_ &&
                             A.border_size() == border_;
    matrix_ = &A;
    if (same_values) return status_;
    if (!same_pattern) find_diagonal(A);
    pattern_version_ = A.body.pattern_version();
    values_version_ = A.values_version;
    nodal_ = A.nodal_size();
    border_ = A.border_size();
    const ScopedTimer timer(counters_.factor_s);
    ++counters_.factorisations;
    return status_ = make_preconditioner(A);
  }

  SolveStatus solve(const VecX& b, VecX& x) override {
    check_right_hand_side(b.rows());
    const ScopedTimer timer(counters_.solve_s);
    x.resize(b.size());
    remember(1);
    return solve_column(b.data(), x.data(), 0);
  }

  SolveStatus solve(const MatX& B, MatX& X) override {
    check_right_hand_side(B.rows());
    const ScopedTimer timer(counters_.solve_s);
    X.resize(B.rows(), B.cols());
    remember(B.cols());
    for (Eigen::Index c = 0; c < B.cols(); ++c)
      if (const SolveStatus status = solve_column(B.col(c).data(), X.col(c).data(), c);
          status != SolveStatus::kOk)
        return status;
    return SolveStatus::kOk;
  }

 private:
  // --- preconditioner
  void find_diagonal(const BorderedMatrix& A) {
    const ScopedTimer timer(counters_.symbolic_s);
    ++counters_.symbolic;
    diagonal_.resize(static_cast<std::size_t>(A.body.block_rows()));
    for (int i = 0; i < A.body.block_rows(); ++i) diagonal_[static_cast<std::size_t>(i)] = A.body.diagonal(i);
    inverse_.resize(diagonal_.size());
  }

  SolveStatus make_preconditioner(const BorderedMatrix& A) {
    const auto& values = A.body.values();
    const Eigen::Map<const VecX> body(values.data(), static_cast<Eigen::Index>(values.size()));
    if (!all_finite(body) || !all_finite(A.right) || !all_finite(A.bottom) || !all_finite(A.corner))
      return SolveStatus::kSingular;
    Eigen::LLT<Mat3> block;
    for (std::size_t i = 0; i < diagonal_.size(); ++i) {
      // symmetric: storage order does not matter
      block.compute(Eigen::Map<const Mat3>(A.body.block(diagonal_[i])));
      if (block.info() != Eigen::Success) return SolveStatus::kIndefinite;
      inverse_[i] = block.solve(Mat3::Identity());
    }
    return border_ == 0 ? SolveStatus::kOk : make_coarse(A);
  }

  SolveStatus make_coarse(const BorderedMatrix& A) {
    if (W_.rows() != nodal_ || W_.cols() != border_) W_.setZero(nodal_, border_);
    AZ_ = A.right;
    for (Eigen::Index c = 0; c < border_; ++c) {
      if (const SolveStatus status = nodal_response(A, c); status != SolveStatus::kOk) return status;
      A.body.multiply_add(W_.col(c).data(), AZ_.col(c).data());
      ++counters_.iterations;
    }
    E_.noalias() = W_.transpose() * AZ_;
    E_.noalias() += A.bottom * W_;
    E_ += A.corner;
    coarse_.compute(E_);
    return coarse_.info() == Eigen::Success ? SolveStatus::kOk : SolveStatus::kIndefinite;
  }

  /// Computes column c of W, B w = -R_c, approximately; the last w is the initial guess where it reduces the
  /// error.
  SolveStatus nodal_response(const BorderedMatrix& A, Eigen::Index c) {
    auto w = W_.col(c);
    r_ = -A.right.col(c);
    if (r_.isZero(0.0)) {
      w.setZero();
      return SolveStatus::kOk;
    }
    jacobi(r_, z_);
    const double goal = kCoarseTolerance * kCoarseTolerance * r_.dot(z_);
    if (!w.isZero(0.0)) {
      Ap_.setZero(nodal_);
      A.body.multiply_add(w.data(), Ap_.data());
      ++counters_.iterations;
      const double curvature = w.dot(Ap_);
      if (curvature <= 0.0) return SolveStatus::kIndefinite;
      const double a = w.dot(r_) / curvature;
      w *= a;
      r_ -= a * Ap_;
      jacobi(r_, z_);
    }
    double rho = r_.dot(z_);
    p_ = z_;
    for (int i = 0; i < kCoarseLimit && rho > goal; ++i) {
      Ap_.setZero(nodal_);
      A.body.multiply_add(p_.data(), Ap_.data());
      ++counters_.iterations;
      const double curvature = p_.dot(Ap_);
      if (curvature <= 0.0) return SolveStatus::kIndefinite;
      const double a = rho / curvature;
      w += a * p_;
      r_ -= a * Ap_;
      jacobi(r_, z_);
      const double next = r_.dot(z_);
      p_ = z_ + (next / rho) * p_;
      rho = next;
    }
    return SolveStatus::kOk;
  }

  /// z = J^-1 r on the nodes; z is resized to the size of r.
  void jacobi(const VecX& r, VecX& z) const {
    z.resize(r.size());
    for (std::size_t i = 0; i < inverse_.size(); ++i) {
      const auto at = 3 * static_cast<Eigen::Index>(i);
      z.segment<3>(at).noalias() = inverse_[i] * r.segment<3>(at);
    }
  }

  void precondition(const VecX& r, VecX& z) {
    jacobi(r, z);
    if (border_ == 0) return;
    y_ = r.tail(border_);
    y_.noalias() += W_.transpose() * r.head(nodal_);
    coarse_.matrixL().solveInPlace(y_);
    coarse_.matrixU().solveInPlace(y_);
    z.head(nodal_).noalias() += W_ * y_;
    z.tail(border_) = y_;
  }

  // --- iteration
  void check_right_hand_side(Eigen::Index rows) const {
    PALPATE_CHECK(status_ == SolveStatus::kOk, "solver pcg: solve() called before factor()");
    PALPATE_CHECK(matrix_->values_version == values_version_,
                  "solver pcg: the matrix changed between factor and solve");
    PALPATE_CHECK(rows == nodal_ + border_, "right-hand side has {} rows, the matrix {}", rows,
                  nodal_ + border_);
  }

  /// Allocates room for the last solutions of `count` columns; a change of system size discards them.
  void remember(Eigen::Index count) {
    if (last_.rows() != nodal_ + border_) last_.setZero(nodal_ + border_, count);
    if (last_.cols() >= count) return;
    const Eigen::Index had = last_.cols();
    last_.conservativeResize(Eigen::NoChange, count);
    last_.rightCols(count - had).setZero();
  }

  void multiply(const VecX& v, VecX& Av) {
    matrix_->multiply(v, Av);
    ++counters_.iterations;
  }

  SolveStatus solve_column(const double* right_hand_side, double* solution, Eigen::Index column) {
    ++counters_.solves;
    // a copy, since solution and right-hand side may be the same memory
    b_ = Eigen::Map<const VecX>(right_hand_side, nodal_ + border_);
    x_.setZero(b_.size());
    const SolveStatus status = b_.isZero(0.0) ? SolveStatus::kOk : iterate(last_.col(column));
    if (status != SolveStatus::kOk) return status;
    last_.col(column) = x_;
    Eigen::Map<VecX>(solution, b_.size()) = x_;
    return status;
  }

  SolveStatus iterate(const Eigen::Ref<const VecX>& guess) {
    precondition(b_, z_);
    const double limit = rtol_ * b_.norm(), limit_p = rtol_ * std::sqrt(b_.dot(z_));
    if (!std::isfinite(limit_p)) return SolveStatus::kNotConverged;
    r_ = b_;
    if (!guess.isZero(0.0)) {
      p_ = guess;
      multiply(p_, Ap_);
      const double curvature = p_.dot(Ap_);
      if (curvature <= 0.0) return SolveStatus::kIndefinite;
      const double a = p_.dot(b_) / curvature;
      x_ = a * p_;
      r_ -= a * Ap_;
    }
    long left = kIterationLimit;
    for (int replacement = 0; replacement <= kResidualReplacements; ++replacement) {
      const SolveStatus status = reduce_residual(limit, limit_p, left);
      if (status != SolveStatus::kOk) return status;
      multiply(x_, Ap_);
      r_ = b_ - Ap_;
      precondition(r_, z_);
      if (r_.norm() <= limit && std::sqrt(r_.dot(z_)) <= limit_p) return SolveStatus::kOk;
    }
    return SolveStatus::kNotConverged;
  }

  /// Iterates from x and its residual r until the recurrence's r is below both limits.
  SolveStatus reduce_residual(double limit, double limit_p, long& left) {
    precondition(r_, z_);
    double rho = r_.dot(z_);
    p_ = z_;
    while (r_.norm() > limit || std::sqrt(rho) > limit_p) {
      if (left-- == 0 || !std::isfinite(rho)) return SolveStatus::kNotConverged;
      multiply(p_, Ap_);
      const double curvature = p_.dot(Ap_);
      if (curvature <= 0.0) return SolveStatus::kIndefinite;
      const double a = rho / curvature;
      x_ += a * p_;
      r_ -= a * Ap_;
      precondition(r_, z_);
      const double next = r_.dot(z_);
      p_ = z_ + (next / rho) * p_;
      rho = next;
    }
    return std::isfinite(rho) ? SolveStatus::kOk : SolveStatus::kNotConverged;
  }

  double rtol_;
  dynamics::SolverCounters counters_;
  const BorderedMatrix* matrix_ = nullptr;  ///< matrix of the last factor()
  std::uint64_t pattern_version_ = 0, values_version_ = 0;
  Eigen::Index nodal_ = 0, border_ = 0;
  SolveStatus status_ = SolveStatus::kSingular;
  std::vector<int> diagonal_;  ///< slot of each node's diagonal block
  std::vector<Mat3> inverse_;
  MatX W_, AZ_, E_;          ///< coarse space: nodes' response to the border; nodes' rows of A Z; Z^T A Z
  Eigen::LLT<MatX> coarse_;  ///< Cholesky factor of E
  MatX last_;                ///< last solution of each column
  VecX b_, x_, r_, z_, p_, Ap_, y_;
};

}  // namespace

std::unique_ptr<dynamics::LinearSolver> make_pcg(const IntegratorSpec& spec) {
  check_linear_rtol("pcg", spec);
  return std::make_unique<Pcg>(spec.linear_rtol);
}

}  // namespace palpate::linear
