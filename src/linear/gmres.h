#pragma once
#include <array>
#include <memory>
#include <vector>

#include "linear/symmetric_part.h"
#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

/// Solves unsymmetric systems by flexible GMRES (Saad 1993), preconditioned from the right by a solver of the
/// symmetric part (Concus and Golub 1976, Widlund 1978):
///     A = S + N,  S = (A + A^T)/2 positive definite,  N = (A - A^T)/2:      A S^-1 = I + N S^-1.
/// Residuals are measured in the norm |r|^2 = r . S^-1 r.  In its inner product K = N S^-1 is skew, so the
/// spectrum of I + K lies on the line Re = 1 within Im = +-s, and
///     |r_k| <= 2 rho^k |b|,   rho = s / (1 + sqrt(1 + s^2)),   s = |K| the largest |x . N y| / |x|_S |y|_S,
/// however fine the mesh.  A contact with friction adds k (n - mu s) n^T.  Where the stiffness of a node
/// along s is t times that of the contact, k, in the plane of n and s
///     S = k [ 1 + t  -mu/2 ]     N = k [   0    mu/2 ]     s = (mu/2) / sqrt(t (1 + t) - mu^2/4),
///           [ -mu/2    t   ]           [ -mu/2    0  ]
/// 0.11 for mu = 0.3 and t = 1: an iteration gains more than a digit.  Contact stiffer than the nodes behind
/// it by 4/mu^2 makes S indefinite though A is regular: factor() returns kIndefinite, and A has to be
/// factored.
///
/// The norm costs nothing: every basis vector v_i comes with z_i = S^-1 v_i, which is the search direction
/// too, so that <v_i, w> = z_i . w.  The method is flexible because S may be solved by an iteration to two
/// digits; z_i is then no linear map of v_i, and A Z = V H holds all the same.
///
/// Termination: |b - A x| <= rtol |b| in this norm.  For the error e,
///     |e|_S^2 = e . A e = e . r <= |e|_S |r|,  |b| = |A x| <= (1 + s) |x|_S:   |e|_S <= rtol (1 + s) |x|_S,
/// a relative bound in the energy norm, whatever units forces and moments have.
///
/// Accuracy for Newton's method.  SUNDIALS takes a direct solver's correction d for exact and estimates from
/// the norms of corrections how they contract; the convergence test (adapter.cpp) never assumes a rate below
/// 0.05.  An error of rtol (1 + s) |d|_S adds that much to the rate in the energy norm, and in the weighted
/// norm of velocities, uniform as the mass is, at most sqrt(q) times as much, q = h^2 w^2 with w the highest
/// frequency.  With rtol = 1e-8 it stays below a fiftieth of 0.05 up to h w = 1e5.
class Gmres final : public dynamics::LinearSolver {
 public:
  /// Solves with the factor of S, exactly; a matrix that is symmetric to rounding (friction without contact)
  /// takes one such solution.
  /// @param symmetric  direct solver, kept by its owner.  counters() leaves its counters out.
  Gmres(double rtol, dynamics::LinearSolver& symmetric);
  /// Solves with S by `symmetric` as roughly as that does; counters() includes its counters.
  Gmres(double rtol, std::unique_ptr<dynamics::LinearSolver> symmetric);

  std::string name() const override { return "gmres"; }
  bool supports_unsymmetric() const override { return true; }
  bool supports_indefinite() const override { return false; }
  /// Counts right-hand sides as solves and products with A as iterations.
  const dynamics::SolverCounters& counters() const override;
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A) override;
  /// Returns kNotConverged after kDirections directions: s is then larger than about 3.
  dynamics::SolveStatus solve(const VecX& b, VecX& x) override;
  dynamics::SolveStatus solve(const MatX& B, MatX& X) override;
  /// Returns the number of search directions used so far.
  long directions() const { return directions_; }

 private:
  /// They reach 1e-8 up to s = 3.  The memory of a solve is two vectors per direction used; a step with
  /// friction takes about ten.
  static constexpr int kDirections = 60;

  void check(Eigen::Index rows) const;
  void multiply(const VecX& v, VecX& Av);
  dynamics::SolveStatus precondition(const VecX& r, VecX& z);
  dynamics::SolveStatus solve_column();
  dynamics::SolveStatus reduce_residual(double size, double goal);
  void keep_direction(std::size_t k, double size);

  /// Givens rotation of rows k and k + 1.
  struct Rotation {
    double c = 1.0, s = 0.0;
    void make(double a, double b);
    template <class Columns>
    void rotate(Columns& M, int row, int column) const;
  };

  double rtol_;
  std::unique_ptr<dynamics::LinearSolver> owned_;  ///< Null where the symmetric solver is a direct one.
  dynamics::LinearSolver& symmetric_;
  SymmetricPart part_;
  const dynamics::BorderedMatrix* matrix_ = nullptr;  ///< Last argument of factor().
  std::uint64_t values_version_ = 0;
  dynamics::SolveStatus status_ = dynamics::SolveStatus::kSingular;
  std::vector<VecX> V_, Z_;  ///< Basis, and S^-1 of it.
  MatX H_, g_;
  std::array<Rotation, kDirections> rotation_;
  VecX b_, x_, r_, z_, y_;
  long directions_ = 0;
  dynamics::SolverCounters counters_;
  mutable dynamics::SolverCounters sum_;
};

}  // namespace palpate::linear
