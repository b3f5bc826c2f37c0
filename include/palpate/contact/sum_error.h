#pragma once
#include "palpate/core/archive.h"

namespace palpate::contact {

/// Quadrature error of the sum over points that approximates the integral of the depth over a contact, and
/// the share of the largest term. The force is the stiffness times this sum. Over a run both are relative to
/// the largest sum, because a contact that begins has few points and hence large relative errors of small
/// forces.
class SumError {
 public:
  /// Sum of one query.
  struct Query {
    double sum = 0.0;           ///< Sum of depth times area over all points [m^3]; 0 where nothing overlaps.
    double error = 0.0;         ///< Estimated error of the sum [m^3].
    double largest_term = 0.0;  ///< Largest term, due to one point [m^3].
  };
  /// Records the sum of a query.
  void take(const Query& query);

  const Query& last() const { return last_; }  ///< Returns the sum of the last query.
  /// Returns the relative error of the last sum [-].
  double last_relative() const { return last_.sum > 0.0 ? last_.error / last_.sum : 0.0; }
  /// Returns the largest error divided by the largest sum [-].
  double largest() const { return of_largest_sum(largest_error_); }
  /// Returns the largest term divided by the largest sum [-]: a bound on the change caused by a point whose
  /// nearest point jumps.
  double largest_share() const { return of_largest_sum(largest_term_); }
  void archive(Archive& a);  ///< Saves or restores the maxima.

 private:
  double of_largest_sum(double x) const { return largest_sum_ > 0.0 ? x / largest_sum_ : 0.0; }

  Query last_;
  double largest_sum_ = 0.0, largest_error_ = 0.0, largest_term_ = 0.0;
};

}  // namespace palpate::contact
