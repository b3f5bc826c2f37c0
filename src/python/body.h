#pragma once
#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "simulation.h"

namespace palpate::python {

/// Body of a simulation, by index.
struct BodyOf {
  std::shared_ptr<Simulation> simulation;
  std::size_t index;
  const loop::Body& body() const { return simulation->world().bodies[index]; }
  const dynamics::Block& block() const { return *simulation->world().state.layout().find(body().block_id); }
  pybind11::object owner() const { return pybind11::cast(simulation); }
};

/// Returns the body of that name.  @throws Error where the scene has none
BodyOf find_body(const std::shared_ptr<Simulation>& self, const std::string& name);

}  // namespace palpate::python
