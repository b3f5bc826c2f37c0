#include "contact.h"

#include "bindings.h"

namespace py = pybind11;

namespace palpate::python {

ContactNow contact_of(const std::shared_ptr<Simulation>& self) {
  const Simulation::Lease lease(*self);
  loop::World& world = self->world();
  return {
      Kept(world.contact ? world.contact->points(world.state.view()) : std::vector<contact::ContactPoint>())};
}

namespace {

/// Makes an array with one row per sample: `width` values of a record's member; width 0: one value.
template <class T>
py::array sample_rows(const ContactNow& self, const T& (*member)(const contact::ContactPoint&),
                      py::ssize_t width) {
  static const contact::ContactPoint none{};
  const auto& points = self.points.get();
  const T* data = &member(points.empty() ? none : points.front());
  constexpr py::ssize_t step = sizeof(contact::ContactPoint);
  if (width == 0) return view(data, {self.size()}, {step}, self.points.owner());
  return view(data, {self.size(), width}, {step, static_cast<py::ssize_t>(sizeof(T))}, self.points.owner());
}

py::array sample_forces(const ContactNow& self) {
  Points forces(3, self.size());
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    const contact::ContactPoint& point = self.points.get()[static_cast<std::size_t>(i)];
    forces.col(i) = point.pressure * point.area * point.normal;
  }
  const Kept<Points> kept(std::move(forces));
  return rows(kept.get().data(), kept.get().cols(), 3, kept.owner());
}

}  // namespace

void bind_contact(py::module_& module) {
  using Point = contact::ContactPoint;
  using Now = ContactNow;
  py::class_<Now>(module, "Contact",
                  "Contact samples of the last query, evaluated at the state on access: one row per sample, "
                  "including samples that are still apart.")
      .def_property_readonly(
          "positions",
          [](const Now& self) {
            return sample_rows<double>(
                self, [](const Point& p) -> const double& { return p.a[0]; }, 3);
          },
          "Positions on the surface that the normals push away, (s, 3) [m].")
      .def_property_readonly(
          "opposite_positions",
          [](const Now& self) {
            return sample_rows<double>(
                self, [](const Point& p) -> const double& { return p.b[0]; }, 3);
          },
          "Positions on the other surface, (s, 3) [m].")
      .def_property_readonly(
          "normals",
          [](const Now& self) {
            return sample_rows<double>(
                self, [](const Point& p) -> const double& { return p.normal[0]; }, 3);
          },
          "Unit normals, (s, 3).")
      .def_property_readonly(
          "gaps",
          [](const Now& self) {
            return sample_rows<double>(
                self, [](const Point& p) -> const double& { return p.gap; }, 0);
          },
          "Gaps, (s,) [m]; negative is penetration.")
      .def_property_readonly(
          "areas",
          [](const Now& self) {
            return sample_rows<double>(
                self, [](const Point& p) -> const double& { return p.area; }, 0);
          },
          "Areas of the samples, (s,) [m^2].")
      .def_property_readonly(
          "pressures",
          [](const Now& self) {
            return sample_rows<double>(
                self, [](const Point& p) -> const double& { return p.pressure; }, 0);
          },
          "Pressures, (s,) [Pa]; 0 where the surfaces are apart.")
      .def_property_readonly("forces", &sample_forces,
                             "Pressure times area along the normal, (s, 3) [N]; without friction.")
      .def_property_readonly(
          "pairs",
          [](const Now& self) {
            return sample_rows<int>(
                self, [](const Point& p) -> const int& { return p.pair; }, 0);
          },
          "Index of the [[contact]] in the scene, (s,).")
      .def("__len__", [](const Now& self) { return self.size(); });
}

}  // namespace palpate::python
