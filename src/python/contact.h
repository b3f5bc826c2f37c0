#pragma once
#include <memory>
#include <vector>

#include "arrays.h"
#include "palpate/contact/query_view.h"
#include "simulation.h"

namespace palpate::python {

/// The contact samples of the last query, at the state as it was when they were asked for.
struct ContactNow {
  Kept<std::vector<contact::ContactPoint>> points;
  pybind11::ssize_t size() const { return static_cast<pybind11::ssize_t>(points.get().size()); }
};

ContactNow contact_of(const std::shared_ptr<Simulation>& self);

}  // namespace palpate::python
