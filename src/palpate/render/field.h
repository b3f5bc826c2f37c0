#pragma once
#include <string>
#include <vector>

#include "palpate/render/colour_map.h"
#include "palpate/render/picture.h"

namespace palpate::render {

/// Values on a regular grid: a map of penetration depth.
struct Field {
  int width = 0, height = 0;
  /// width x height, rows from below as OpenGL reads them; NaN: no value, drawn pale
  std::vector<double> values;
  double cell = 0.0;  ///< edge of a value's square [m], for the bar that shows a length; 0: none
};

/// A picture of a field, each value a square of `magnify` pixels (0: chosen so that the longer side is about
/// 800), with its colour scale, a title and a line under it.  No GPU is used. Counts "render.picture".
Picture draw_field(const Field& field, const ColourScale& scale, const std::string& title, int magnify = 0,
                   const std::string& subtitle = {});

}  // namespace palpate::render
