#pragma once
#include <array>

#include "linear/mixed_precision/single_matrix.h"

namespace palpate::linear {

/// Initial guess of an iteration: the best combination of the last solutions in the energy norm (Fischer
/// 1998),
///     x = V y,   V^T A V y = V^T b.
/// More solutions extrapolate a smooth motion more accurately; each adds to the cost of the product A V. V is
/// known before the matrix is: A V is formed while the matrix is packed and still in cache.
///
/// V is kept and A V formed in single precision. V spans the last solutions by the newest one and its
/// backward differences: the extrapolation of a smooth motion is their plain sum, whereas in terms of the
/// solutions themselves it is a difference of large multiples that amplifies their roundings. A V is computed
/// from differences between neighbours; its error is a few roundings in the energy norm. x is the exact
/// combination of V, a valid start like any other; the residual has the error of A V (kTrustsSingleStart,
/// single_solve.cpp).
class ProjectedGuess {
 public:
  /// @param most  Number of solutions kept, up to kMostColumns.
  ProjectedGuess(const NodeKernels& kernels, int most) : kernels_(kernels), most_(most) {}

  /// Allocates vectors over the nodes of this order and discards all solutions.
  void prepare(const NodeOrder& order);
  int count() const { return count_; }
  /// V, in the order's numbering.
  Singles* solutions() { return V_; }
  Singles* products() { return AV_; }  ///< scale A V
  void products_are_known(bool known) { known_ = followed_ = known; }
  bool products_known() const { return known_; }
  /// Whether A V is known, or was updated from solution to solution of one matrix.
  bool products_followed() const { return followed_; }

  /// Begins a right-hand side b; the functions below follow in this order. x is at first the extrapolated
  /// next solution, with the coefficients of the last start; before the first start they are all one, a
  /// polynomial extrapolation. If `warm` is false, x is zero.
  void begin(bool warm, double scale);
  /// Adds up the inner products with b that choose() needs, on the nodes of a part. b must stay unchanged.
  void add_up(std::size_t part, const double* b, int first, int last);
  /// Result of choose().
  struct Start {
    double energy;  ///< |x|_A^2
    double change;  ///< |x - extrapolated solution|_A^2
    double size;    ///< |b - A x| of the extrapolated solution, about equal to that of x; nonzero
  };
  /// Sets x to the best combination. A solution in the span of newer ones is left out.
  Start choose();
  /// Writes x on nodes [first, last) to an array that begins with node `first`.
  void solution(double* x, int first, int last) const;
  /// Writes A x on nodes [first, last) to an array that begins with node `first`.
  void product(double* Ax, int first, int last) const;
  /// r = by (b - A x)
  void residual(double by, const double* b, float* r, int first, int last) const;

  /// Stores a solution x: begin_to_keep() makes room, keep() takes x on ranges of nodes that together cover
  /// all of them, with Ax = A x where products are followed, and end_to_keep() takes the largest number in
  /// it. The oldest solution is dropped; all are dropped if solutions differ so much in magnitude that they
  /// are unrelated.
  void begin_to_keep(double scale, bool with_products);
  void keep(const double* x, const double* Ax, int first, int last);
  void end_to_keep(double largest);

 private:
  /// Solves V^T A V y = V^T b into of_AV_.
  double solve();
  /// Discards all solutions.
  void forget();

  const NodeKernels& kernels_;
  int most_;
  Singles V_[kMostColumns], AV_[kMostColumns];  ///< newest solution and its backward differences
  float *at_V_[kMostColumns] = {}, *at_AV_[kMostColumns] = {};
  double unit_ = 1.0, next_unit_ = 1.0;  ///< unit of V_: a power of two
  double share_[kMostColumns];           ///< coefficients of V_ in the last start
  int count_ = 0;
  bool known_ = false;  ///< AV_ is A V of the current matrix and the current V_
  /// As known_, but up to the rounding of A x, which is not computed from differences between neighbours.
  bool followed_ = false;
  double scale_ = 1.0;
  int used_ = 0;                                        ///< columns used in this start
  double of_V_[kMostColumns], of_AV_[kMostColumns];     ///< coefficients of x in V_ and of A x in AV_
  double by_ = 1.0, change_ = 1.0;                      ///< scales of the solution being stored
  std::vector<std::array<double, kMostSums>> partial_;  ///< sums per part
  double own_[kMostColumns][kMostColumns] = {}, right_[kMostColumns] = {};  ///< V^T A V, V^T b
};

}  // namespace palpate::linear
