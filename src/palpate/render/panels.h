#pragma once
#include <string>
#include <vector>

#include "palpate/render/picture.h"

namespace palpate::render {

/// Pictures of one height side by side.  @throws InternalError where the heights differ
Picture beside(const std::vector<Picture>& pictures);

/// A quantity over time.
struct Curve {
  std::string label, unit;            ///< "force on the hand", "N"; ticks take an SI prefix
  std::vector<double> times, values;  ///< [s], ascending; in the unit
};

/// The picture with the curve in a strip beneath it, whose axes fit all of it, and a mark at one time. Strips
/// of one curve differ in the mark alone.
/// @param now     the time of the picture [s]
/// @param height  of the strip [pixels]
Picture with_curve(const Picture& picture, const Curve& curve, double now, int height);

}  // namespace palpate::render
