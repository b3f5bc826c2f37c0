#pragma once
#include "canvas.h"
#include "render/scene.h"

namespace palpate::render {

/// Returns the margins that the texts need, so that they never cover the scene.
/// @param scale  colour scale as drawn; empty: none
Margins margins_of(const Scene& scene, const Options& options, const std::optional<ColourScale>& scale);

/// Draws a vertical colour bar with ticks to its right; for a flat scale, one colour and its number.
void draw_scale(Canvas& canvas, const ColourScale& scale, double x, double y, double width, double height,
                double text_size);

/// Returns the picture with title and subtitle at the top left, colour bar at the right, names of plain
/// surfaces and the grid spacing at the bottom left.
Picture annotated(const Picture& picture, const Scene& scene, const ColourScale& scale, bool with_scale,
                  double grid_spacing);

}  // namespace palpate::render
