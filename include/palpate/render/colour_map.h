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
};

/// The scale with both ends known: `least` and `greatest` where it leaves them open, and never empty.
ColourScale settled(const ColourScale& scale, double least, double greatest);

}  // namespace palpate::render
