#pragma once
#include "render/scene.h"
#include "session/world_snapshot.h"

namespace palpate::session {

/// Returns the surfaces coloured by `shade`, tool and handle, and bones visible through the tissue; without
/// obstacles.
/// @param largest  upper end of the range of colours before it is rounded; 0: the largest value of the
/// snapshot
render::Scene scene_of(const loop::World& world, const WorldSnapshot& snapshot, Shade shade,
                       double largest = 0.0);

/// Returns the bounding view of all surfaces: the part of an unbounded obstacle that is drawn.
contact::View view_of(const render::Scene& scene);
/// Adds the obstacles of the world, cut to the view.
void add_obstacles(render::Scene& scene, const loop::World& world, const contact::View& view);

}  // namespace palpate::session
