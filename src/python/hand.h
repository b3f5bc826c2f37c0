#pragma once
#include <pybind11/numpy.h>

#include <memory>
#include <string>

#include "simulation.h"

namespace palpate::python {

/// Hand of a simulation, by index.
struct HandOf {
  std::shared_ptr<Simulation> simulation;
  std::size_t index;
  std::string name;
};

/// Returns the hand of that name.  @throws Error where the scene has none
HandOf find_hand(const std::shared_ptr<Simulation>& self, const std::string& name);

/// Returns force or torque on that hand at its last tick, (3,) [N], [N m]; zero before the first.
pybind11::array last_force(const HandOf& hand);
pybind11::array last_torque(const HandOf& hand);

}  // namespace palpate::python
