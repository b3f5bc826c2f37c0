#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/loop/run.h"
#include "render/scene.h"

namespace palpate::cli {

/// What colours a picture.
enum class Shade { kDisplacement, kStress, kPenetration };

/// Refuses at the start what could not be drawn at the end.
/// @param name  "displacement", "stress" or "penetration"
/// @throws Error where pictures were not compiled in, for another name, and for penetration in a scene
///   without [[contact]]
Shade check_picture(const std::string& name, const scene::Description& description);

/// A World at one time, as pictures show it, and small: positions of the nodes, not of the skins.
struct Instant {
  double time = 0.0;
  std::vector<Points> nodes;  ///< of each body [m]
  std::vector<VecX> stress;   ///< of each body, at its nodes [Pa]; empty for other shades
  /// of each body: vertices of its surface that lie in what they touch, and how deep [m]; empty for other
  /// shades
  std::vector<std::vector<std::pair<int, float>>> depths;
  std::vector<Pose> bones;
  std::vector<Pose> tools;     ///< of each hand
  std::optional<Pose> handle;  ///< that the first hand holds; empty: not drawn
};

/// @pre for penetration: right after a query, with views kept (loop/contact_instant.h)
Instant instant_of(loop::World& world, double time, Shade shade);

/// Surfaces as `shade` colours them, tool and handle, and bones seen through the tissue; without obstacles.
render::Scene scene_of(const loop::World& world, const Instant& instant, Shade shade);

/// The box around all surfaces: how much of an obstacle without an end is worth drawing.
contact::View view_of(const render::Scene& scene);
void add_obstacles(render::Scene& scene, const loop::World& world, const contact::View& view);

}  // namespace palpate::cli
