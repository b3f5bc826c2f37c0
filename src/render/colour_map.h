#pragma once
#include <limits>
#include <string>
#include <string_view>

#include "palpate/core/types.h"
#include "render/picture.h"

namespace palpate::render {

/// Returns a colour given as "#rrggbb".
/// @throws InternalError for another format
Rgb colour_of(std::string_view hex);

/// Returns the colour of a value at `t` on the range of a scale (core/object_colours.h: kRamp), from a pale
/// body at 0 to dark magenta at 1. `t` is clamped to [0, 1].
Rgb ramp(double t);

/// Mapping from values to colours, and the labels of the colour bar.
struct ColourScale {
  std::string label;  ///< Quantity: "displacement".
  std::string unit;   ///< Unit: "m"; ticks use an SI prefix where that is easier to read (mm).
  double low = std::numeric_limits<double>::quiet_NaN();   ///< Lower end; NaN: the least finite value.
  double high = std::numeric_limits<double>::quiet_NaN();  ///< Upper end; NaN: the greatest finite value.
  /// Differences up to this are rounding errors: where all values differ by no more, one colour and one
  /// number are shown.  Without it a body at rest would be drawn in all colours, over a range of 1e-17 m.
  double resolution = 0.0;
  std::string note = {};  ///< Remark under the colour bar: "without rigid motion"; empty: none.
  bool is_flat() const { return high == low; }  ///< Whether a settled scale has only one value.
};

/// Returns the scale with both ends known and finite: `least` and `greatest` replace open ends; flat where
/// they differ by no more than its resolution.
ColourScale settled(const ColourScale& scale, double least, double greatest);

/// Returns the position of a value on a settled scale, in [0, 1]; 0 where it is flat.
double share(const ColourScale& scale, double value);

}  // namespace palpate::render
