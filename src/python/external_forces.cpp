#include "external_forces.h"

#include "palpate/integrate/integrators.h"

namespace palpate::python {

dynamics::TermTraits ExternalForces::traits() const {
  return {.stiff = false,
          .fast = false,
          .symmetric_tangent = true,
          .has_tangent = true,
          .conservative = false,  // the caller changes them: they have no potential
          .zero_tangent = true};
}

void ExternalForces::add_force(const dynamics::StateView& state, VecX& f) {
  f.segment(state.layout->find(block_id_)->u_offset, forces_.size()) += forces_;
}

std::vector<std::shared_ptr<ExternalForces>> add_external_forces(loop::World& world) {
  std::vector<std::shared_ptr<ExternalForces>> out;
  for (const loop::Body& body : world.bodies) {
    out.push_back(
        std::make_shared<ExternalForces>(body.block_id, world.state.layout().find(body.block_id)->u_size));
    world.system.add(out.back());
  }
  if (out.empty()) return out;
  world.system.prepare(world.state.view());
  world.stepper = integrate::make_stepper(world.system, world.state, world.description.integrator);
  return out;
}

}  // namespace palpate::python
