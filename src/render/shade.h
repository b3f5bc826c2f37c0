#pragma once
#include "palpate/render/scene.h"

namespace palpate::render {

/// All that shading needs beyond the scene, decided before.
struct Staging {
  ColourScale scale;  ///< both ends known
  Camera camera;
  Vec3 centre;              ///< of the scene's surfaces [m]
  double radius = 1.0;      ///< of a ball about the centre that holds them [m]
  double grid_spacing = 0;  ///< [m]; 0: no ground
};

/// The scene without any text, at width x height of the options:
/// drawn `supersampling` times larger and averaged.
Picture shade(const Scene& scene, const Staging& staging, const Options& options);

}  // namespace palpate::render
