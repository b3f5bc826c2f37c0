#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/loop/run.h"
#include "session/shade.h"

namespace palpate::session {

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

}  // namespace palpate::session
