#pragma once
#include <string>
#include <vector>

#include "render/picture.h"

namespace palpate::render {

/// Joins pictures of one height from left to right.  @throws InternalError where the heights differ
Picture beside(const std::vector<Picture>& pictures);

/// Quantity over time.
struct Curve {
  std::string label, unit;            ///< "force on the hand", "N"; ticks use an SI prefix.
  std::vector<double> times, values;  ///< [s], ascending; in `unit`.
};

/// Returns the picture with a plot of the curve in a strip beneath it, with axes that fit the whole curve,
/// and a mark at one time.  Strips of one curve differ only in the mark.
/// @param now     time of the picture [s]
/// @param height  height of the strip [pixels]
Picture with_curve(const Picture& picture, const Curve& curve, double now, int height);

}  // namespace palpate::render
