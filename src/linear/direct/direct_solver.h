#pragma once
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "linear/direct/body_factor.h"

namespace palpate::linear {

/// Direct solver of a bordered matrix, for any BodyFactor. The border is eliminated by its Schur complement:
///     [A R] [x]   [b]      W = A^-1 R,  S = C - B W  (once per factor)
///     [B C] [y] = [c]      z = A^-1 b,  y = S^-1 (c - B z),  x = z - W y  (once per right-hand side)
/// so that the fill of the sparse factor does not depend on the number of nodes that the tool touches.
/// factor() returns kSingular if a value is not finite or, for LU, a pivot is zero to rounding; also if the
/// body alone is singular, even where the border would make the whole matrix regular.
class DirectSolver final : public dynamics::LinearSolver {
 public:
  /// @param name  As in the registry.
  /// @param unsymmetric  Whether `body` factors unsymmetric matrices (LU); else symmetric positive definite
  ///   ones.
  /// @param body  Factor of the sparse part.
  DirectSolver(std::string name, bool unsymmetric, std::unique_ptr<BodyFactor> body);
  std::string name() const override { return name_; }
  bool supports_unsymmetric() const override { return unsymmetric_; }
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A) override;
  dynamics::SolveStatus solve(const MatX& B, MatX& X) override;
  dynamics::SolveStatus solve(const VecX& b, VecX& x) override;
  const dynamics::SolverCounters& counters() const override { return counters_; }

 private:
  bool same_pattern(const dynamics::BorderedMatrix& A) const;
  dynamics::SolveStatus factor_values(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus factor_border(const dynamics::BorderedMatrix& A);
  void solve_border(MatX& Y) const;
  void solve_columns(const double* b, double* x, Eigen::Index count);

  std::string name_;
  bool unsymmetric_;
  std::unique_ptr<BodyFactor> body_;
  dynamics::SolverCounters counters_;
  std::uint64_t pattern_version_ = 0, values_version_ = 0;
  Eigen::Index nodal_ = -1, border_ = 0;
  dynamics::SolveStatus status_ = dynamics::SolveStatus::kSingular;
  MatX bottom_, W_, S_;   ///< border: B, A^-1 R, C - B W
  Eigen::LLT<MatX> llt_;  ///< Cholesky factor of a symmetric S
  Eigen::PartialPivLU<MatX> lu_;
  MatX z_, y_;  ///< scratch memory of a solve
};

}  // namespace palpate::linear
