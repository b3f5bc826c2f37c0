#include "palpate/loop/world.h"

#ifdef PALPATE_HAS_TOOL
#include "palpate/tool/tool.h"
#else
namespace palpate::tool {
class Tool {};
}  // namespace palpate::tool
#endif

namespace palpate::loop {

World::World() = default;
World::~World() = default;

const Body* World::find_body(const std::string& name) const {
  for (const Body& b : bodies)
    if (b.name == name) return &b;
  return nullptr;
}

Points World::positions(const Body& body) const {
  const dynamics::Block* block = state.layout().find(body.block_id);
  return Eigen::Map<const Points>(state.q().data() + block->q_offset, 3, block->q_size / 3);
}

double World::mechanical_energy() {
  const dynamics::StateView view = state.view();
  return system.kinetic_energy(view) + system.potential_energy(view);
}

}  // namespace palpate::loop
