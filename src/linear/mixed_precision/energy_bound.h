#pragma once
#include <cmath>
#include <vector>

namespace palpate::linear {

// The error of conjugate gradients in the energy norm, from its own coefficients.  The method is the Gauss
// rule of a Stieltjes integral whose value is
// |x - x_0|_A^2 (Golub and Meurant 1994): with the step lengths alpha_k and rho_k = r_k . P^-1 r_k,
//     |x - x_0|_A^2 = sum_{j<k} alpha_j rho_j + |x - x_k|_A^2,                                   all terms
//     positive.
// The Gauss-Radau rule with a node mu below every eigenvalue of P^-1 A bounds what is left (Meurant and Tichy
// 2013, section 3):
//     |x - x_k|_A^2 <= g_k rho_k,    g_0 = 1/mu,    g_{k+1} = (g_k - alpha_k) / (mu (g_k - alpha_k) +
//     rho_{k+1}/rho_k).
// mu: the rule itself tells when it lies above the smallest Ritz value (g_k <= alpha_k): mu is then halved
// and the recurrence run again.  The bound is taken with half of that, as eigenvalues may lie below the Ritz
// values; from one solve to the next mu is kept, and rises by a tenth, as matrices change slowly.
// Coefficients of an iteration that rounding has spoilt (contact 1e9 times as stiff as a body) may fit no
// spectrum at all: then nothing is known of the error until the next solve.

/// Bounds the energy-norm error of one solve; mu outlives it.
class EnergyBound {
 public:
  /// @param start  |x_0|_A^2 with x - x_0 orthogonal to x_0 in A's scalar product; where they are not, |x -
  ///   x_0|_A^2 is far below it
  /// @param rise  of mu since the last solve
  void begin(double start, double rise = kRise);
  static constexpr double kRise = 1.1;
  /// After a step of length alpha from rho to rho_next.
  void step(double alpha, double rho, double rho_next);
  /// Upper bound of |x - x_k|_A^2 for this rho_k; rho may be measured anew.
  double error(double rho) const { return lost_ ? HUGE_VAL : bound_ * rho; }
  /// Lower bound of |x - x_0|_A^2: what the steps so far have gained.
  double gained() const { return gained_; }
  /// Lower bound of |x|_A^2.
  double solution() const { return start_ + gained_; }
  bool first() const { return first_; }
  /// Below every eigenvalue, as far as is known.
  double mu() const { return mu_; }
  /// It is no more than this; before the first step of a solve.
  void limit(double mu);
  void end() { first_ = false; }

 private:
  void restart();
  bool advance(double alpha, double ratio);

  bool lost_ = false;  ///< no mu fits this solve
  bool first_ = true;  ///< no solve has ended yet: mu is not known
  double mu_ = 1.0, test_ = 0.0, bound_ = 0.0, start_ = 0.0, gained_ = 0.0;
  std::vector<double> alpha_, ratio_;
};

}  // namespace palpate::linear
