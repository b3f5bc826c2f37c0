#pragma once
#include <string>
#include <vector>

#include "palpate/loop/world.h"

namespace palpate::loop {

/// Penetration depth of a [[contact]], and quadrature error of its sum over points.
struct PenetrationReport {
  std::string pair;        ///< "head - tool", for messages.
  double deepest_m = 0.0;  ///< Largest overlap of all queries; 0: no contact.
  /// Half of the smallest extent of the two sides' bounding boxes: deeper overlaps may be pushed out at the
  /// far side, or not at all. Infinite without contact. For a body against itself, kOwnShare of the depth up
  /// to which self-overlaps are detected.
  double half_width_m = 0.0;
  bool of_itself = false;  ///< Contact of a body with itself.
  /// Fraction of the detectable depth of self-overlaps at which a run reports them as too deep, before they
  /// are missed.
  static constexpr double kOwnShare = 0.75;
  double quadrature_error = 0.0;  ///< Relative, as contact::SumError::largest(); 0: not estimated.
  double largest_share = 0.0;     ///< Largest contribution of a single point.
  bool too_deep() const { return deepest_m > half_width_m; }
};

/// Returns PenetrationReport::half_width_m of a [[contact]], by its number, as where its sides touch.
double penetration_limit(const World& world, std::size_t contact);

/// Returns the entry of one [[contact]], by its number.
PenetrationReport penetration_report(const World& world, std::size_t contact);

/// Returns one entry per [[contact]] of the scene.
std::vector<PenetrationReport> penetration_reports(const World& world);

}  // namespace palpate::loop
