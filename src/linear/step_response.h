#pragma once
#include <memory>

#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::linear {

/// Computes the response of a step matrix A, projected onto a few right-hand sides B (size x columns),
///     S = B^T A^-1 B   (columns x columns),
/// by a truncated iteration. The error is of second order in the error of the solutions. Use: the Schur
/// complement of a large matrix onto a small system (a tool that touches a body) to a per cent or so, at the
/// cost of a few passes over the matrix.
///
/// Method: block conjugate gradients on all columns together, in single precision, started from the best
/// combination of the last call's solutions. With the approximate solutions X and the residual R = B - A X,
///     S = B^T X + X^T R + E^T A E,     E = X - A^-1 B.
/// The neglected last term is quadratic in the error of X: columns with an error of a tenth leave a hundredth
/// in S. It is positive semi-definite, so S is approached from below.
class StepResponse {
 public:
  /// @param threads  Threads that share the products; results do not depend on their number.
  explicit StepResponse(int threads);
  ~StepResponse();

  /// Returns the storage of a step matrix of this pattern, to be written by the caller and then prepared by
  /// take_step_matrix(). `pattern` must stay valid until the next call.
  dynamics::ZeroRowSumMatrix& step_matrix(const dynamics::BlockSparse& pattern);
  /// Prepares the matrix that was written to step_matrix() (preconditioner, coarse space). Returns
  /// kIndefinite if a diagonal block is not positive definite, kSingular if a value is not finite.
  dynamics::SolveStatus take_step_matrix();

  /// Returns the largest ratio, over the nodes, of a node's stiffness from contact (ZeroRowSumMatrix::points)
  /// to its stiffness without contact. Where it is far above one, the iteration converges slowly and its
  /// error bound is loose.
  double point_stiffness() const;

  /// Starts the iteration for the right-hand sides B, size x columns, zero along held directions, from the
  /// best combination of the last solutions.
  /// @returns kNotConverged if the start is not finite, kIndefinite if the matrix turns out indefinite
  dynamics::SolveStatus begin(const MatX& B);
  /// Returns the current approximation of S, columns x columns.
  const MatX& response() const;
  /// Returns estimated upper bounds of the missing part of each S_ii (energy_bound.h); infinite while nothing
  /// is known of the spectrum. The error of S_ij is at most the geometric mean of the bounds of S_ii and
  /// S_jj.
  const VecX& error_bound() const;
  /// Returns an estimate of the missing part of each S_ii by the preconditioner, diag(R^T P^-1 R). It serves
  /// to detect right-hand sides that need no further iteration.
  VecX residual_energies() const;
  /// Performs one iteration: one pass over the matrix per five columns. Returns kIndefinite or kNotConverged
  /// (a value is not finite) as begin().
  dynamics::SolveStatus advance();
  /// Returns X^T A X of the current solutions X.
  MatX energies() const;
  /// Writes the current approximation of column k of A^-1 B to x.
  void solution(Eigen::Index k, VecX& x) const;

  /// Returns the number of passes over the matrix so far, each for up to five columns.
  long products() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::linear
