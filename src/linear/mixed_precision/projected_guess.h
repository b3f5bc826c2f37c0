#pragma once
#include <array>

#include "linear/mixed_precision/single_matrix.h"

namespace palpate::linear {

/// Where an iteration starts: the best combination of the last solutions in the energy norm (Fischer 1998),
///     x = V y,   V^T A V y = V^T b.
/// The more of them, the more of a smooth motion they foresee; each costs its share of that reading.
/// V is known before the matrix is: A V is formed while the matrix is packed and still at hand.
/// V is kept and A V formed in single precision.  V spans the last solutions by the newest one and its
/// backward differences: what a smooth motion goes on with is their plain sum, where of the solutions
/// themselves it is a difference of large multiples, and with it of their roundings.  A V comes from
/// differences between neighbours, and is off by some roundings in the energy norm.  x is its combination of
/// V to the last digit, a start like any other; the residual is as wrong as A V (kTrustsSingleStart,
/// single_solve.cpp).
class ProjectedGuess {
 public:
  /// @param most  solutions that are kept, up to kMostColumns
  ProjectedGuess(const NodeKernels& kernels, int most) : kernels_(kernels), most_(most) {}

  /// Forgets; vectors over the nodes of this order.
  void prepare(const NodeOrder& order);
  int count() const { return count_; }
  Singles* solutions() { return V_; }
  Singles* products() { return AV_; }  ///< with scale A
  void products_are_known(bool known) { known_ = followed_ = known; }
  bool products_known() const { return known_; }
  /// Known, or followed from solution to solution of one matrix.
  bool products_followed() const { return followed_; }

  /// One right-hand side b, by what follows in this order.  First x is the next solution as far as it is
  /// foreseen, with the shares that the last start took, in the first ones those of a polynomial; `warm`
  /// false: zero.
  void begin(bool warm, double scale);
  /// What choose() needs of a part's nodes, where b is from then on.
  void add_up(std::size_t part, const double* b, int first, int last);
  struct Start {
    double energy;  ///< |x|_A^2
    double change;  ///< |x - what was foreseen|_A^2
    double size;    ///< |b - A x| of what was foreseen, about that of x; not zero
  };
  /// x becomes the best.  A solution that lies in the span of newer ones gives nothing new and is left out.
  Start choose();
  /// x and A x on nodes [first, last), to numbers that begin with node `first`.
  void solution(double* x, int first, int last) const;
  void product(double* Ax, int first, int last) const;
  /// r = by (b - A x)
  void residual(double by, const double* b, float* r, int first, int last) const;

  /// Takes a solution: makes room, takes it on ranges of nodes that make up all of them, with Ax = A x where
  /// products are followed, and the largest number in it.  The oldest is forgotten.  So is everything where
  /// solutions differ by so much in size that they say nothing of each other.
  void begin_to_keep(double scale, bool with_products);
  void keep(const double* x, const double* Ax, int first, int last);
  void end_to_keep(double largest);

 private:
  double solve();
  void forget();

  const NodeKernels& kernels_;
  int most_;
  Singles V_[kMostColumns], AV_[kMostColumns];  ///< the newest solution, and its backward differences
  float *at_V_[kMostColumns] = {}, *at_AV_[kMostColumns] = {};
  double unit_ = 1.0, next_unit_ = 1.0;  ///< of V_: a power of two
  double share_[kMostColumns];           ///< of each of V_ in the last start
  int count_ = 0;
  bool known_ = false;  ///< AV_ is of the present matrix and the present V_
  /// it is so up to the roundings of A x, which are not of differences between neighbours
  bool followed_ = false;
  double scale_ = 1.0;
  int used_ = 0;                                        ///< columns of this start
  double of_V_[kMostColumns], of_AV_[kMostColumns];     ///< their shares in x and in A x
  double by_ = 1.0, change_ = 1.0;                      ///< of the solution that is being taken
  std::vector<std::array<double, kMostSums>> partial_;  ///< one a part
  double own_[kMostColumns][kMostColumns] = {}, right_[kMostColumns] = {};  ///< V^T A V, V^T b
};

}  // namespace palpate::linear
