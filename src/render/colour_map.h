#pragma once
#include <limits>
#include <string>

#include "palpate/core/types.h"
#include "render/picture.h"

namespace palpate::render {

/// Returns the colour of viridis (Smith and van der Walt 2015), from dark violet at 0 to yellow at 1: equal
/// steps of value are equal steps of lightness, also for readers with colour deficiencies and in greyscale
/// print.  `t` is clamped to [0, 1].
Rgb viridis(double t);

/// Mapping from values to colours, and the labels of the colour bar.
struct ColourScale {
  std::string label;  ///< Quantity: "displacement".
  std::string unit;   ///< Unit: "m"; ticks use an SI prefix where that is easier to read (mm).
  double low = std::numeric_limits<double>::quiet_NaN();   ///< Lower end; NaN: the least finite value.
  double high = std::numeric_limits<double>::quiet_NaN();  ///< Upper end; NaN: the greatest finite value.
  /// Differences up to this are rounding errors: where all values differ by no more, one colour and one
  /// number are shown.  Without it a body at rest would be drawn in all colours, over a range of 1e-17 m.
  double resolution = 0.0;
  bool is_flat() const { return high == low; }  ///< Whether a settled scale has only one value.
};

/// Returns the scale with both ends known and finite: `least` and `greatest` replace open ends; flat where
/// they differ by no more than its resolution.
ColourScale settled(const ColourScale& scale, double least, double greatest);

/// Returns the position of a value on a settled scale, in [0, 1]; 0 where it is flat.
double share(const ColourScale& scale, double value);

}  // namespace palpate::render
