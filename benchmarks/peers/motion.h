#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/loop/world.h"

namespace peers {

using namespace palpate;

/// State of a run: positions and velocities of all nodes.
struct Snapshot {
  double time = 0.0;  ///< [s]
  VecX q, u;
};

/// Run of a scene with two soft bodies, and its states with overlapping skins.
struct Motion {
  scene::Description description;
  std::unique_ptr<loop::World> world;
  std::vector<Snapshot> states;

  const loop::Body& body(int k) const { return world->bodies[static_cast<std::size_t>(k)]; }
  int triangles() const;
  int vertices() const;
};

/// Runs a scene and records the states in which its skins overlap.
/// @param scene path of its file
/// @throws Error if the scene does not have two soft bodies with skins, or they never touch
Motion record_motion(const std::string& scene);

/// Vertices [m] of a body's skin in a state, computed from its nodes.
class SkinPositions {
 public:
  SkinPositions(const loop::World& world, const loop::Body& body);
  const Points& at(const Snapshot& state);
  const Faces& faces() const { return body_.skin->rest.faces; }

 private:
  const loop::Body& body_;
  int offset_;  ///< Offset of the body's nodes in q.
  Points nodes_, vertices_;
};

}  // namespace peers
