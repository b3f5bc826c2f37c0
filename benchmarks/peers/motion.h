#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/loop/world.h"

namespace peers {

using namespace palpate;

/// One state of a run: positions and velocities of all nodes.
struct Snapshot {
  double time = 0.0;  ///< [s]
  VecX q, u;
};

/// The run of a scene with two soft bodies, and those of its states in which their skins overlap.
struct Motion {
  scene::Description description;
  std::unique_ptr<loop::World> world;
  std::vector<Snapshot> states;

  const loop::Body& body(int k) const { return world->bodies[static_cast<std::size_t>(k)]; }
  int triangles() const;
  int vertices() const;
};

/// @param scene  path of its file
/// @throws Error where the scene has not two soft bodies with skins, or they never touch
Motion record_motion(const std::string& scene);

/// The skin's vertices of a body in a state, from its nodes [m].
class SkinPositions {
 public:
  SkinPositions(const loop::World& world, const loop::Body& body);
  const Points& at(const Snapshot& state);
  const Faces& faces() const { return body_.skin->rest.faces; }

 private:
  const loop::Body& body_;
  int offset_;  ///< of the body's nodes in q
  Points nodes_, vertices_;
};

}  // namespace peers
