#pragma once
#include <memory>
#include <vector>

#include "arrays.h"
#include "palpate/contact/query_view.h"
#include "simulation.h"

namespace palpate::python {

/// Contact samples of the last query, evaluated at the state when they were requested.
struct ContactNow {
  Kept<std::vector<contact::ContactPoint>> points;
  pybind11::ssize_t size() const { return static_cast<pybind11::ssize_t>(points.get().size()); }
};

/// Returns the contact samples at the present state.
ContactNow contact_of(const std::shared_ptr<Simulation>& self);

}  // namespace palpate::python
