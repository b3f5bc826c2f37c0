#pragma once
#include <cmath>
#include <vector>

namespace palpate::linear {

// Bounds of the energy-norm error of conjugate gradients from the method's coefficients. Conjugate gradients
// are the Gauss rule of a Stieltjes integral with the value |x - x_0|_A^2 (Golub and Meurant 1994): with the
// step lengths alpha_k and rho_k = r_k . P^-1 r_k,
//     |x - x_0|_A^2 = sum_{j<k} alpha_j rho_j + |x - x_k|_A^2,   all terms positive.
// The Gauss-Radau rule with a node mu below every eigenvalue of P^-1 A bounds the remainder (Meurant and
// Tichy 2013, section 3):
//     |x - x_k|_A^2 <= g_k rho_k,   g_0 = 1/mu,
//     g_{k+1} = (g_k - alpha_k) / (mu (g_k - alpha_k) + rho_{k+1}/rho_k).
// Choice of mu: the recurrence itself detects a mu above the smallest Ritz value (g_k <= alpha_k); mu is then
// halved and the recurrence repeated. The bound uses half of that mu, as eigenvalues may lie below the Ritz
// values. mu is kept from one solve to the next and rises by a tenth, as matrices change slowly.
// Coefficients of an iteration that rounding has spoilt (contact 1e9 times as stiff as a body) may fit no
// spectrum at all: then no bound is known until the next solve.

/// Bounds the energy-norm error of one solve; mu is kept from solve to solve.
class EnergyBound {
 public:
  /// Begins a solve.
  /// @param start  |x_0|_A^2 if x - x_0 is A-orthogonal to x_0; where it is not, |x - x_0|_A^2 must be far
  ///   below |x_0|_A^2.
  /// @param rise  Factor on mu since the last solve.
  void begin(double start, double rise = kRise);
  static constexpr double kRise = 1.1;
  /// Records a step of length alpha that changed rho to rho_next.
  void step(double alpha, double rho, double rho_next);
  /// Upper bound of |x - x_k|_A^2 for this rho_k, which may be a recomputed one; infinite if no mu fits.
  double error(double rho) const { return lost_ ? HUGE_VAL : bound_ * rho; }
  /// Lower bound of |x - x_0|_A^2: energy gained by the steps so far.
  double gained() const { return gained_; }
  /// Lower bound of |x|_A^2.
  double solution() const { return start_ + gained_; }
  /// Whether no solve has ended yet, so that mu is not known.
  bool first() const { return first_; }
  /// Estimated lower bound of all eigenvalues of P^-1 A.
  double mu() const { return mu_; }
  /// Lowers mu to at most this value. Call before the first step of a solve.
  void limit(double mu);
  /// Ends a solve: mu is known from now on.
  void end() { first_ = false; }

 private:
  /// Restarts the recurrences of the bound with mu_.
  void restart();
  /// Advances both recurrences by one step; returns false if mu_ lies above the smallest Ritz value.
  bool advance(double alpha, double ratio);

  bool lost_ = false;  ///< no mu fits this solve
  bool first_ = true;  ///< no solve has ended yet: mu is not known
  /// test_, bound_: recurrences g_k with mu_ and with half of it; start_: |x_0|_A^2; gained_: sum of
  /// alpha rho.
  double mu_ = 1.0, test_ = 0.0, bound_ = 0.0, start_ = 0.0, gained_ = 0.0;
  std::vector<double> alpha_, ratio_;
};

}  // namespace palpate::linear
