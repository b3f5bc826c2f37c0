// Bindings of a body's state that the caller sets, and of forces on its nodes.
#include "arrays.h"
#include "bindings.h"
#include "body.h"
#include "palpate/core/error.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

/// Reads one row per node of three finite numbers.
VecX nodal_rows(const py::object& value, const std::string& what, py::ssize_t nodes) {
  using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const Rows rows = Rows::ensure(value);
  if (!rows) {
    PyErr_Clear();
    fail("{} must be an array of numbers, ({}, 3)", what, nodes);
  }
  if (rows.ndim() != 2 || rows.shape(0) != nodes || rows.shape(1) != 3) {
    std::string shape;
    for (py::ssize_t i = 0; i < rows.ndim(); ++i)
      shape += fmt::format("{}{}", i > 0 ? ", " : "", rows.shape(i));
    fail("{} must have the shape ({}, 3), one row per node, and has ({})", what, nodes, shape);
  }
  VecX out = Eigen::Map<const VecX>(rows.data(), rows.size());
  if (!out.allFinite()) fail("{} must be finite numbers", what);
  return out;
}

/// Sets positions [m] and velocities [m/s] of a body's nodes; None leaves them. Driven nodes keep their
/// prescribed motion.
void set_state(const BodyOf& self, const py::object& positions, const py::object& velocities) {
  const py::ssize_t nodes = self.body().placed.cols();
  std::optional<VecX> q, u;
  if (!positions.is_none()) q = nodal_rows(positions, "positions", nodes);
  if (!velocities.is_none()) u = nodal_rows(velocities, "velocities", nodes);
  const Simulation::Lease lease(*self.simulation);
  loop::World& world = self.simulation->world();
  dynamics::State& state = world.state;
  if (q) state.q().segment(self.block().q_offset, q->size()) = *q;
  if (u) state.u().segment(self.block().u_offset, u->size()) = *u;
  world.system.impose(state.layout(), state.time(), state.q().data(), state.u().data());
  self.simulation->changed(dynamics::ReinitReason::kStateChanged);
}

/// Sets the external forces on a body's nodes.
void apply_forces(const BodyOf& self, const py::object& forces) {
  const VecX f = nodal_rows(forces, "forces", self.body().placed.cols());
  const Simulation::Lease lease(*self.simulation);
  self.simulation->external_forces(self.index).set(f);
  self.simulation->changed(dynamics::ReinitReason::kParametersChanged);
}

/// Returns a view of the external forces.
py::array external_forces(const BodyOf& self) {
  const VecX& forces = self.simulation->external_forces(self.index).forces();
  return rows(forces.data(), forces.size() / 3, 3, self.owner());
}

}  // namespace

void bind_body_state(py::module_& module) {
  py::reinterpret_borrow<py::class_<BodyOf>>(module.attr("Body"))
      .def_property_readonly("external_forces", &external_forces,
                             "Forces set by apply_forces, (n, 3) [N]: a view.")
      .def("apply_forces", &apply_forces, py::arg("forces"),
           "Sets external forces on the nodes, (n, 3) [N], that act until the next call; needs "
           "Simulation(external_forces=True).")
      .def(
          "set_state", &set_state, py::arg("positions") = py::none(), py::arg("velocities") = py::none(),
          "Sets positions [m] and velocities [m/s] of the nodes, (n, 3) each; None leaves them.  Fixed nodes "
          "keep theirs.");
}

}  // namespace palpate::python
