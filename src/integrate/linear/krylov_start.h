#pragma once
#include <array>

#include "integrate/linear/single_matrix.h"

namespace palpate::integrate {

/// Where an iteration starts: the best combination of the last solutions in the energy norm (Fischer 1998),
///     x = V y,   V^T A V y = V^T b.
/// The more of them, the more of a smooth motion they foresee; each costs its share of that reading.
/// V is known before the matrix is: A V is formed while the matrix is packed and still at hand.
/// V is kept and A V formed in single precision.  V spans the last solutions by the newest one and its backward differences: what a smooth motion goes on with is their plain sum,
/// where of the solutions themselves it is a difference of large multiples, and with it of their roundings.  A V comes from differences between neighbours, and is off by
/// some roundings in the energy norm.  x is its combination of V to the last digit, a start like any other; the residual is as wrong as A V (kTrustsSingleStart, single_pcg.cpp).
class KrylovStart {
 public:
  /// @param most  solutions that are kept, up to kMostColumns
  KrylovStart(const NodeKernels& kernels, ClusterTeam& team, int most) : kernels_(kernels), team_(team), most_(most) {}

  /// Forgets; vectors over the nodes of this order.
  void prepare(const NodeOrder& order);
  int count() const { return count_; }
  Singles* solutions() { return V_; }
  Singles* products() { return AV_; }  ///< with scale A
  void products_are_known(bool known) { known_ = followed_ = known; }
  bool products_known() const { return known_; }
  /// Known, or followed from solution to solution of one matrix.
  bool products_followed() const { return followed_; }

  struct Start {
    double energy;    ///< |x|_A^2
    double residual;  ///< |b - A x|
    double change;    ///< |x - what was foreseen|_A^2
  };
  /// The next solution as far as it is foreseen: with the shares that the last start took, in the first ones those of a polynomial.  x, and Ax = A x.
  void foresee(double scale, Doubles& x, Doubles& Ax);
  /// x = V y and Ax = A V y, both written whole; `warm` false: zero.  A solution that lies in the span of newer ones gives nothing new and is left out.
  Start combine(bool warm, double scale, const Doubles& b, Doubles& x, Doubles& Ax);
  /// Takes a solution, the largest number in it, and Ax = A x (null: products are followed no further); the oldest is forgotten.
  void keep(const Doubles& x, double largest, double scale, const Doubles* Ax);

 private:
  void gather_sums(const Doubles& b);
  double add_up(int count, const double* y, double scale, const Doubles& b, Doubles& x, Doubles& Ax);
  double solve(double* y) const;

  const NodeKernels& kernels_;
  ClusterTeam& team_;
  int most_;
  Singles V_[kMostColumns], AV_[kMostColumns];  ///< the newest solution, and its backward differences
  double unit_ = 1.0;  ///< of V_: a power of two
  double share_[kMostColumns];  ///< of each of V_ in the last start
  int count_ = 0;
  bool known_ = false;     ///< AV_ is of the present matrix and the present V_
  bool followed_ = false;  ///< it is so up to the roundings of A x, which are not of differences between neighbours
  std::vector<std::array<double, kMostSums>> partial_;  ///< one a part
  double own_[kMostColumns][kMostColumns] = {}, right_[kMostColumns] = {};  ///< V^T A V, V^T b
};

}  // namespace palpate::integrate
