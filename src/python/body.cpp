#include "body.h"

#include <fmt/format.h>

#include "arrays.h"
#include "bindings.h"
#include "palpate/core/error.h"

namespace py = pybind11;

namespace palpate::python {

BodyOf find_body(const std::shared_ptr<Simulation>& self, const std::string& name) {
  std::vector<std::string> names;
  for (const loop::Body& body : self->world().bodies) {
    if (body.name == name) return {self, names.size()};
    names.push_back(body.name);
  }
  fail("the scene has no body \"{}\"{}", name, suggestion(name, names));
}

namespace {

py::array node_rows(const BodyOf& self, const double* of_block, int size) {
  return rows(of_block, size / 3, 3, self.owner());
}

py::array node_forces(const BodyOf& self) {
  const Simulation::Lease lease(*self.simulation);
  loop::World& world = self.simulation->world();
  VecX force;
  world.system.force(world.state.view(), force);
  const Kept<VecX> kept(std::move(force));
  return rows(kept.get().data() + self.block().u_offset, self.block().u_size / 3, 3, kept.owner());
}

py::array surface_positions(const BodyOf& self) {
  const Simulation::Lease lease(*self.simulation);
  const Kept<Points> kept(self.body().surface_points(self.simulation->world().positions(self.body())));
  return rows(kept.get().data(), kept.get().cols(), 3, kept.owner());
}

}  // namespace

void bind_body(py::module_& module) {
  using Body = BodyOf;
  py::class_<Body>(module, "Body",
                   "One body of a simulation.  Nodes are in the order of the state; file_node has their "
                   "numbers in the mesh file and in output files.")
      .def_property_readonly("name", [](const Body& self) { return self.body().name; })
      .def_property_readonly(
          "positions",
          [](const Body& self) {
            return node_rows(self, self.simulation->world().state.q().data() + self.block().q_offset,
                             self.block().q_size);
          },
          "Positions of the nodes in the world, (n, 3) [m]: a view that follows the simulation.")
      .def_property_readonly(
          "velocities",
          [](const Body& self) {
            return node_rows(self, self.simulation->world().state.u().data() + self.block().u_offset,
                             self.block().u_size);
          },
          "Velocities of the nodes, (n, 3) [m/s]: a view that follows the simulation.")
      .def_property_readonly(
          "rest_positions",
          [](const Body& self) {
            return rows(self.body().placed.data(), self.body().placed.cols(), 3, self.owner());
          },
          "Initial positions of the nodes in the world, (n, 3) [m].")
      .def_property_readonly(
          "masses",
          [](const Body& self) {
            return rows(self.body().masses.data(), self.body().masses.size(), self.owner());
          },
          "Lumped masses of the nodes, (n,) [kg].")
      .def_property_readonly("forces", &node_forces,
                             "Sum of elastic, damping, contact and weight forces on each node at present, "
                             "(n, 3) [N]; computed on access.")
      .def_property_readonly(
          "tetrahedra",
          [](const Body& self) {
            const Tets& tets = self.body().rest.tets;
            return rows(tets.data(), tets.cols(), 4, self.owner());
          },
          "Node numbers of each tetrahedron, (m, 4).")
      .def_property_readonly(
          "file_node",
          [](const Body& self) {
            const std::vector<int>& numbers = self.body().file_node;
            return rows(numbers.data(), static_cast<py::ssize_t>(numbers.size()), self.owner());
          },
          "Number of each node in the mesh file, (n,): out[file_node] = values reorders.")
      .def_property_readonly(
          "has_skin", [](const Body& self) { return self.body().skin.has_value(); },
          "Whether the surface is a skin, and not the boundary of the tetrahedra.")
      .def_property_readonly(
          "surface_faces",
          [](const Body& self) {
            const Faces& faces = self.body().surface_faces();
            return rows(faces.data(), faces.cols(), 3, self.owner());
          },
          "Faces of the surface for contact and pictures: vertex numbers, (k, 3).")
      .def_property_readonly("surface_positions", &surface_positions,
                             "Present positions of that surface's vertices, (v, 3) [m]; computed on access.")
      .def("__repr__", [](const Body& self) {
        return fmt::format("<palpate.Body \"{}\" of {} nodes>", self.body().name, self.body().placed.cols());
      });
}

}  // namespace palpate::python
