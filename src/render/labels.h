#pragma once
#include <string>
#include <vector>

#include "render/scene.h"

namespace palpate::render {

/// Text at a point of the scene.
struct Label {
  Vec3 at;           ///< world [m]
  std::string text;  ///< one line
  Rgb colour = {0.12f, 0.14f, 0.18f};
};

/// Draws the scene as draw() does, and the labels over it: each centred at its point, and visible through the
/// surfaces.  Values of the scene's surfaces are not shown.
/// @throws Error as draw()
Picture draw_labelled(Scene scene, Options options, const std::vector<Label>& labels);

}  // namespace palpate::render
