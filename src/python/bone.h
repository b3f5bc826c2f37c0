#pragma once
#include <memory>
#include <string>

#include "simulation.h"

namespace palpate::python {

/// Bone of a simulation, by index.
struct BoneOf {
  std::shared_ptr<Simulation> simulation;
  std::size_t index;
  const loop::Bone& bone() const { return simulation->world().bones[index]; }
};

/// Returns the bone of that name.  @throws Error where the scene has none
BoneOf find_bone(const std::shared_ptr<Simulation>& self, const std::string& name);

}  // namespace palpate::python
