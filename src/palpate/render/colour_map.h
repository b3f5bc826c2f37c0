#pragma once
#include <limits>
#include <string>

#include "palpate/core/types.h"
#include "palpate/render/picture.h"

namespace palpate::render {

/// Viridis (Smith and van der Walt 2015), from dark violet at 0 to yellow at 1: even steps of value are even
/// steps of lightness, for readers with colour deficiencies and on grey paper too.  `t` is clamped to [0, 1].
Rgb viridis(double t);

/// How values become colours, and what the scale beside the picture says.
struct ColourScale {
  std::string label;  ///< "displacement"
  std::string unit;   ///< "m"; ticks take an SI prefix where that reads better (mm)
  double low = std::numeric_limits<double>::quiet_NaN();   ///< NaN: the least finite value
  double high = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the greatest
  /// What is nearer than this is rounding: values that differ by no more have one colour, and the scale one
  /// number.  Without it a body at rest is drawn in all colours of 1e-17 m.
  double resolution = 0.0;
  bool is_flat() const { return high == low; }  ///< of a settled one: there is only one value
};

/// The scale with both ends known and finite: `least` and `greatest` where it leaves them open; flat where
/// they are nearer than its resolution.
ColourScale settled(const ColourScale& scale, double least, double greatest);

/// Where a value lies on a settled scale, in [0, 1]; 0 where it is flat.
double share(const ColourScale& scale, double value);

}  // namespace palpate::render
