#include "bone.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>

#include "arrays.h"
#include "bindings.h"
#include "palpate/core/error.h"

namespace py = pybind11;

namespace palpate::python {

BoneOf find_bone(const std::shared_ptr<Simulation>& self, const std::string& name) {
  std::vector<std::string> names;
  for (const loop::Bone& bone : self->world().bones) {
    if (bone.name == name) return {self, names.size()};
    names.push_back(bone.name);
  }
  if (names.empty()) fail("the scene has no bone \"{}\": it has no [[bone]] and no [body.skeleton]", name);
  fail("the scene has no bone \"{}\"{}", name, suggestion(name, names));
}

namespace {

/// Evaluates a vector of the bone at the present state.
template <class Value>
auto evaluated(const Value& value) {
  return [value](const BoneOf& self) {
    const Simulation::Lease lease(*self.simulation);
    return copied(value(self.simulation->world(), self));
  };
}

py::array rotation_of(const BoneOf& self) {
  const Simulation::Lease lease(*self.simulation);
  return copied(self.simulation->world().bone_pose(self.bone()).rotation);
}

}  // namespace

void bind_bone(py::module_& module) {
  using World = loop::World;
  py::class_<BoneOf>(module, "Bone", "One rigid bone of a simulation; values at present, computed on access.")
      .def_property_readonly("name", [](const BoneOf& self) { return self.bone().name; })
      .def_property_readonly(
          "mass", [](const BoneOf& self) { return self.bone().mass; },
          "Mass of a free bone [kg]; 0 for a fixed or scripted one.")
      .def_property_readonly(
          "position", evaluated([](World& w, const BoneOf& b) { return w.bone_pose(b.bone()).translation; }),
          "Position of the origin of its axes, (3,) [m].")
      .def_property_readonly("rotation", &rotation_of, "Orientation: unit quaternion w, x, y, z, (4,).")
      .def_property_readonly(
          "velocity", evaluated([](World& w, const BoneOf& b) { return w.bone_twist(b.bone()).linear; }),
          "Velocity of the origin, (3,) [m/s].")
      .def_property_readonly("angular_velocity", evaluated([](World& w, const BoneOf& b) {
                               return w.bone_twist(b.bone()).angular;
                             }),
                             "Angular velocity, (3,) [rad/s].")
      .def_property_readonly(
          "force", evaluated([](World& w, const BoneOf& b) { return w.wrenches_on_bones()[b.index].force; }),
          "Force of the tissue on the bone, (3,) [N].")
      .def_property_readonly("torque", evaluated([](World& w, const BoneOf& b) {
                               return w.wrenches_on_bones()[b.index].moment;
                             }),
                             "Torque of the tissue about the origin, (3,) [N m].")
      .def("__repr__",
           [](const BoneOf& self) { return fmt::format("<palpate.Bone \"{}\">", self.bone().name); });
}

}  // namespace palpate::python
