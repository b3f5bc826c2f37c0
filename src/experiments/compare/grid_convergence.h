#pragma once
#include <limits>
#include <string>
#include <vector>

/// Discretisation error of a figure from its values on a sequence of meshes, without a reference.
///
/// With an error c h^p the values f1 (finest), f2, f3 on meshes of sizes h1 < h2 < h3 give order and limit,
///
///     (f3 - f2)/(f2 - f1) = r21^p (r32^p - 1)/(r21^p - 1),   r21 = h2/h1, r32 = h3/h2,
///     f = f1 + (f1 - f2)/(r21^p - 1)                         (Richardson 1911),
///
/// and the grid convergence index F |f1 - f2|/(r21^p - 1) is the uncertainty of f (Roache 1994, "Perspective:
/// a method for uniform reporting of grid refinement studies").  F = 1.25 where the three values are in the
/// asymptotic range; else the order is limited to [0.5, 2] and F = 3 (Oberkampf and Roy 2010, 8.6).  Without
/// an order, f = f1 and the uncertainty is three times the largest difference of two values (Eca and Hoekstra
/// 2014).
namespace palpate::compare {

/// Kind of a sequence of values.
enum class Convergence {
  kAsymptotic,   ///< Three levels, monotone, of an order that linear elements may have.
  kMonotone,     ///< Three levels, monotone, of another order: outside the asymptotic range.
  kOscillating,  ///< The last two differences have opposite signs: no order.
  kDiverging,    ///< The last difference is not smaller than the one before: no order.
  kTwoLevels,    ///< The order is assumed.
  kEqual,        ///< The finest two values are equal: the refinement had no effect.
  kTooFew,       ///< Fewer than two levels.
};
/// Returns the kind as a phrase for tables: "asymptotic", "outside the asymptotic range".
std::string to_string(Convergence kind);

/// Limits of the order of a sequence in the asymptotic range.  Displacements and resultants of linear
/// elements have order 2 in smooth problems, 3/2 at the edge of a contact, and about 1 at the edge of a
/// clamped region.
inline constexpr double kLeastOrder = 0.8, kLargestOrder = 2.5;
/// Order assumed for two levels: with a larger true order the estimate is too cautious.
inline constexpr double kAssumedOrder = 1.0;
/// Factors on the difference of two levels.
inline constexpr double kSafety = 1.25, kCautiousSafety = 3.0;

/// Estimate of a figure without the discretisation error.
struct GridEstimate {
  Convergence kind = Convergence::kTooFew;
  double order = std::numeric_limits<double>::quiet_NaN();  ///< Observed order; NaN where there is none.
  /// Extrapolated value, or that of the finest mesh where there is no order; NaN with one level.
  double value = std::numeric_limits<double>::quiet_NaN();
  double uncertainty =
      std::numeric_limits<double>::quiet_NaN();  ///< Half width of the interval about `value`.
};

/// Estimates a figure from its values on a sequence of meshes.
/// @param sizes   sizes of elements, in any unit, falling
/// @param values  one value per mesh, finite
/// @throws InternalError for lists of different lengths
GridEstimate estimate(const std::vector<double>& sizes, const std::vector<double>& values);

}  // namespace palpate::compare
