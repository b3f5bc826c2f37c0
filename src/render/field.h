#pragma once
#include <string>
#include <vector>

#include "render/colour_map.h"
#include "render/picture.h"

namespace palpate::render {

/// Values on a regular grid, such as a map of penetration depth.
struct Field {
  int width = 0, height = 0;
  /// width x height values, rows from bottom to top as OpenGL reads them; NaN: no value, drawn pale.
  std::vector<double> values;
  double cell = 0.0;  ///< Edge of a value's square [m], for the length scale; 0: no length scale.
};

/// Draws a field, each value as a square of `magnify` pixels (0: such that the longer side has about 800),
/// with colour bar, title and subtitle.  Needs no GPU.  Counts "render.picture".
Picture draw_field(const Field& field, const ColourScale& scale, const std::string& title, int magnify = 0,
                   const std::string& subtitle = {});

}  // namespace palpate::render
