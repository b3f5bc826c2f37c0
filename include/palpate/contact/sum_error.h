#pragma once
#include "palpate/core/archive.h"

namespace palpate::contact {

/// What a sum over points or pixels, which stands for the integral of the depth over a contact, says about
/// itself: its own estimate of its error, and how large a part of it one point is.  Force is stiffness times
/// this sum.  Of a run both are told relative to its largest sum: a contact that only begins has few points,
/// hence large relative errors of small forces.
class SumError {
 public:
  /// Takes a query with an overlap.
  /// @param sum  of depth times area over all points [m^3], positive  @param error  estimate of its error
  /// [m^3]
  /// @param largest_term  of one point [m^3]; 0 where points are not told apart
  void take(double sum, double error, double largest_term);

  bool is_empty() const { return largest_sum_ == 0.0; }
  /// Error of the last sum, relative to it [-].
  double last() const { return last_; }
  /// Largest error over the largest sum [-].
  double largest() const { return is_empty() ? 0.0 : largest_error_ / largest_sum_; }
  /// Largest term over the largest sum [-]: it bounds what a point changes that finds another place nearest.
  double largest_share() const { return is_empty() ? 0.0 : largest_term_ / largest_sum_; }
  void archive(Archive& a);

 private:
  double last_ = 0.0, largest_sum_ = 0.0, largest_error_ = 0.0, largest_term_ = 0.0;
};

}  // namespace palpate::contact
