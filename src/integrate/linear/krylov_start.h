#pragma once
#include <array>

#include "integrate/linear/single_matrix.h"

namespace palpate::integrate {

/// Where an iteration starts: the best combination of the last solutions in the energy norm (Fischer 1998),
///     x = V y,   V^T A V y = V^T b.
/// The more of them, the more of a smooth motion they foresee; each costs its share of that reading.
/// V is known before the matrix is: A V is formed while the matrix is copied, in the same reading.
class KrylovStart {
 public:
  /// @param most  solutions that are kept, up to kMostColumns
  KrylovStart(const NodeKernels& kernels, ClusterTeam& team, int most) : kernels_(kernels), team_(team), most_(most) {}

  /// Forgets; vectors over the nodes of this order.
  void prepare(const NodeOrder& order);
  int count() const { return count_; }
  const Doubles* solutions() const { return V_; }
  Doubles* products() { return AV_; }
  void products_are_known(bool known) { known_ = known; }
  bool products_known() const { return known_; }

  struct Start {
    double energy;    ///< |x|_A^2
    double residual;  ///< |b - A x|
  };
  /// x = V y and Ax = A V y, both written whole; `warm` false: zero.  A solution that lies in the span of newer ones gives nothing new and is left out.
  Start combine(bool warm, const Doubles& b, Doubles& x, Doubles& Ax);
  /// Takes a solution in place of the oldest; x is anything afterwards.
  void keep(Doubles& x);

 private:
  void gather_sums(const Doubles& b);
  double solve(double* y) const;

  const NodeKernels& kernels_;
  ClusterTeam& team_;
  int most_;
  Doubles V_[kMostColumns], AV_[kMostColumns];  ///< the newest first
  int count_ = 0;
  bool known_ = false;  ///< AV_ is of the present matrix and the present V_
  std::vector<std::array<double, kMostSums>> partial_;  ///< one a cluster
  double own_[kMostColumns][kMostColumns] = {}, right_[kMostColumns] = {};  ///< V^T A V, V^T b
};

}  // namespace palpate::integrate
