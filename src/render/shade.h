#pragma once
#include "render/scene.h"

namespace palpate::render {

/// Data that shading needs beyond the scene.
struct Staging {
  ColourScale scale;  ///< Both ends known.
  Camera camera;
  Vec3 centre;              ///< Centre of the scene's surfaces and of the framed points [m].
  double radius = 1.0;      ///< Radius of a ball about the centre that contains them [m].
  double grid_spacing = 0;  ///< Spacing of the grid [m]; 0: no ground.
};

/// Renders the scene without text, at width x height of the options; drawn `supersampling` times larger and
/// averaged.
Picture shade(const Scene& scene, const Staging& staging, const Options& options);

}  // namespace palpate::render
