#pragma once
#include "palpate/core/archive.h"

namespace palpate::contact {

/// Quadrature error of the sum over points that approximates the integral of the depth over a
/// contact, and the share of its largest term.  Force is stiffness times this sum.  Over a run both are given
/// relative to the largest sum: a contact that only begins has few points, hence large relative errors of
/// small forces.
class SumError {
 public:
  /// The sum of one query.
  struct Query {
    double sum = 0.0;           ///< of depth times area over all points [m^3]; 0 where nothing overlaps
    double error = 0.0;         ///< estimate of its error [m^3]
    double largest_term = 0.0;  ///< of one point [m^3]
  };
  /// Records the sum of a query.
  void take(const Query& query);

  const Query& last() const { return last_; }  ///< of the last query
  /// Error of the last sum, relative to it [-].
  double last_relative() const { return last_.sum > 0.0 ? last_.error / last_.sum : 0.0; }
  /// Largest error over the largest sum [-].
  double largest() const { return of_largest_sum(largest_error_); }
  /// Largest term over the largest sum [-]: it bounds what a point changes that finds another place nearest.
  double largest_share() const { return of_largest_sum(largest_term_); }
  void archive(Archive& a);  ///< keeps the largest of each, and gives them back

 private:
  double of_largest_sum(double x) const { return largest_sum_ > 0.0 ? x / largest_sum_ : 0.0; }

  Query last_;
  double largest_sum_ = 0.0, largest_error_ = 0.0, largest_term_ = 0.0;
};

}  // namespace palpate::contact
