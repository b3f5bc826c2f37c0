#pragma once
#include <array>
#include <memory>

#include "linear/symmetric_part.h"
#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

/// Flexible GMRES (Saad 1993), preconditioned from the right by a solution with the symmetric part,
///     A = S + N,  S = (A + A^T)/2,  N = (A - A^T)/2:      A S^-1 = I + N S^-1.
/// S^-1/2 N S^-1/2 is skew, so the spectrum of A S^-1 lies on the line Re = 1, within Im = +-|N|_S, the
/// largest |x . N y| over |x|_S |y|_S.  On such a segment the residual falls at least by
///     rho = |N|_S / (1 + sqrt(1 + |N|_S^2))
/// an iteration (Widlund 1978), however fine the mesh.  A contact with friction adds k (n - mu s) n^T.  Where
/// a node's stiffness along s is t times the contact's k, in the plane of n and s
///     S = k [ 1 + t  -mu/2 ]     N = k [   0    mu/2 ]     |N|_S = (mu/2) / sqrt(t (1 + t) - mu^2/4),
///           [ -mu/2    t   ]           [ -mu/2    0  ]
/// 0.11 for mu = 0.3 and t = 1: an iteration takes more than a digit.  Contact stiffer than the nodes behind
/// it by 4/mu^2 makes S indefinite, though A can be solved with: kIndefinite, and whoever asked has to factor
/// A. Flexible, since S is solved for by an iteration of its own to two digits: z_j = S^-1 v_j is then no
/// linear map, and all z_j are kept.
///
/// The end: |b - A x| <= rtol |b|, checked with b - A x itself.
class Gmres final : public dynamics::LinearSolver {
 public:
  /// @param inner  solves with the symmetric part, roughly or not
  Gmres(double rtol, std::unique_ptr<dynamics::LinearSolver> inner);
  std::string name() const override { return "gmres"; }
  bool supports_unsymmetric() const override { return true; }
  bool supports_indefinite() const override { return false; }
  const dynamics::SolverCounters& counters() const override;
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A) override;
  dynamics::SolveStatus solve(const VecX& b, VecX& x) override;
  dynamics::SolveStatus solve(const MatX& B, MatX& X) override;
  long directions() const { return directions_; }  ///< solutions with the symmetric part so far

 private:
  /// Directions kept: the memory of a solve is twice as many vectors.  A step with friction takes about ten.
  static constexpr int kDirections = 40;

  void check(Eigen::Index rows) const;
  void multiply(const VecX& v, VecX& Av);
  dynamics::SolveStatus solve_column();
  dynamics::SolveStatus reduce_residual(double goal);

  /// Of rows k and k + 1 of a column.
  struct Rotation {
    double c = 1.0, s = 0.0;
    void make(double a, double b);
    template <class Columns>
    void rotate(Columns& M, int row, int column) const;
  };

  double rtol_;
  std::unique_ptr<dynamics::LinearSolver> inner_;
  SymmetricPart part_;
  const dynamics::BorderedMatrix* matrix_ = nullptr;  ///< last given to factor()
  std::uint64_t values_version_ = 0;
  dynamics::SolveStatus status_ = dynamics::SolveStatus::kSingular;
  MatX V_, Z_, H_, g_;
  std::array<Rotation, kDirections> rotation_;
  VecX b_, x_, r_, w_, v_, z_, y_;
  long products_ = 0, solves_ = 0, directions_ = 0;
  mutable dynamics::SolverCounters sum_;
};

}  // namespace palpate::linear
