#pragma once
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "linear/direct/body_factor.h"

namespace palpate::linear {

/// Direct solver of a bordered matrix over any BodyFactor.  The border goes by its Schur complement:
///     [A R] [x]   [b]      W = A^-1 R,  S = C - B W  (once a factor)
///     [B C] [y] = [c]      z = A^-1 b,  y = S^-1 (c - B z),  x = z - W y  (once a right-hand side)
/// so the fill of the sparse factor does not depend on how many nodes the tool touches.
/// A matrix is refused as kSingular when a value is not finite or, by LU, a pivot is zero to rounding; also
/// when its body alone is singular, even where the border would make the whole regular.
class DirectSolver final : public dynamics::LinearSolver {
 public:
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
  Eigen::LLT<MatX> llt_;  ///< of S, symmetric
  Eigen::PartialPivLU<MatX> lu_;
  MatX z_, y_;  ///< scratch of a solve
};

}  // namespace palpate::linear
