#pragma once
#include <memory>

#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::linear {

/// How a step matrix A answers a few right-hand sides B, as far as they see it themselves:
///     S = B^T A^-1 B,
/// to an error that is small in a product of two answers and need not be in one.  It serves who wants a Schur
/// complement of a large matrix onto something small (the tool that touches a body), to a percent or so, at
/// the price of a few readings of the matrix.
///
/// The method: conjugate gradients on all columns together, in single precision, from the best combination of
/// the last call's solutions.  With X what has been found and R = B - A X,
///     S = B^T X + X^T R + E^T A E,     E = X - A^-1 B:
/// what is left out is quadratic in the error of X, so that columns with a tenth of error leave a hundredth
/// in S. It is positive: S is approached from below.
class StepResponse {
 public:
  explicit StepResponse(int threads);
  ~StepResponse();

  /// Room for a matrix of this pattern, to be written and then taken.  The pattern stays where it is until
  /// the next call.
  dynamics::ZeroRowSumMatrix& step_matrix(const dynamics::BlockSparse& pattern);
  /// kIndefinite: a diagonal block is not positive definite; kSingular: not finite.
  dynamics::SolveStatus take_step_matrix();

  /// What contact (ZeroRowSumMatrix::points) gives a node over what it has without it, in the node where that
  /// is most: far above one, the iteration is slow and says little of its error.
  double point_stiffness() const;

  /// Begins with the right-hand sides B, zero along held directions; size x columns.  It starts from the last
  /// solutions.
  /// @return kNotConverged where the start is not finite, kIndefinite where the matrix is found to be so
  dynamics::SolveStatus begin(const MatX& B);
  /// S so far.
  const MatX& response() const;
  /// What S_ii is still short of, at most, as far as is known of the matrix (energy_bound.h); the error of
  /// S_ij is at most the root of the product of two of them.
  const VecX& missing() const;
  /// What S_ii is still short of as the preconditioner has it: R^T P^-1 R, a guess by which it is known
  /// whether a right-hand side asks for anything at all.
  VecX residual_energies() const;
  /// One step of the iteration: one reading of the matrix for up to five columns.
  dynamics::SolveStatus advance();
  /// X^T A X of the solutions X as they are.
  MatX energies() const;
  /// Column k of A^-1 B as far as it is known.
  void solution(Eigen::Index k, VecX& x) const;

  /// Readings of the matrix so far, each for up to five columns.
  long products() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::linear
