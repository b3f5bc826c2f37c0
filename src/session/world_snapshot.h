#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/loop/run.h"
#include "render/scene.h"

namespace palpate::session {

/// Quantity that colours a picture.
enum class Shade { kDisplacement, kStress, kPenetration };

/// Checks at the start of a run that pictures of it can be drawn at its end.
/// @param name  "displacement", "stress" or "penetration"
/// @throws Error if pictures were not compiled in, for another name, and for penetration in a scene without
/// [[contact]]
Shade check_picture(const std::string& name, const scene::Description& description);

/// Snapshot of a World for pictures. It is compact: it holds positions of the nodes, not of the skins.
struct WorldSnapshot {
  double time = 0.0;          ///< Simulated time [s]
  std::vector<Points> nodes;  ///< Node positions of each body [m]
  std::vector<VecX> stress;   ///< Nodal von Mises stress of each body [Pa]; empty for other shades
  /// For each body the surface vertices that penetrate another object, with their depth [m]; empty for other
  /// shades
  std::vector<std::vector<std::pair<int, float>>> depths;
  std::vector<Pose> bones;     ///< Pose of each bone
  std::vector<Pose> tools;     ///< Pose of the tool of each hand
  std::optional<Pose> handle;  ///< Handle of the first hand; empty: not drawn
};

/// Returns a snapshot of the world.
/// @pre for penetration: called directly after a query, with views kept (loop/contact_instant.h)
WorldSnapshot snapshot_of(loop::World& world, double time, Shade shade);

/// Returns the surfaces coloured by `shade`, tool and handle, and bones visible through the tissue; without
/// obstacles.
render::Scene scene_of(const loop::World& world, const WorldSnapshot& snapshot, Shade shade);

/// Returns the bounding view of all surfaces: the part of an unbounded obstacle that is drawn.
contact::View view_of(const render::Scene& scene);
/// Adds the obstacles of the world, cut to the view.
void add_obstacles(render::Scene& scene, const loop::World& world, const contact::View& view);

}  // namespace palpate::session
