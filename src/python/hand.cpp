#include "hand.h"

#include "arrays.h"
#include "bindings.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"

namespace py = pybind11;

namespace palpate::python {

HandOf find_hand(const std::shared_ptr<Simulation>& self, const std::string& name) {
  std::vector<std::string> names;
  for (const scene::Hand& hand : scene::hands_of(self->world().description)) {
    if (hand.tool && hand.name == name) return {self, names.size(), name};
    names.push_back(hand.name);
  }
  if (!self->world().description.tool) fail("the scene has no [tool]: there is no hand");
  fail("the scene has no hand \"{}\"{}", name, suggestion(name, names));
}

namespace {

TickLists::List ticks_of(const HandOf& hand) {
  const Simulation::Lease lease(*hand.simulation);
  return hand.simulation->ticks().of(hand.index);
}

/// Makes an array with one row per tick: `width` numbers that `member` selects from its record; width 0: one
/// number.
template <class Member>
py::array tick_rows(const HandOf& hand, const Member& member, py::ssize_t width = 3) {
  const Kept<TickLists::List> kept(ticks_of(hand));
  const std::vector<loop::TickRecord>& ticks = *kept.get();
  static const loop::TickRecord none;
  const double* data = member(ticks.empty() ? none : ticks.front());
  constexpr py::ssize_t step = sizeof(loop::TickRecord);
  const auto n = static_cast<py::ssize_t>(ticks.size());
  if (width == 0) return view(data, {n}, {step}, kept.owner());
  return view(data, {n, width}, {step, static_cast<py::ssize_t>(sizeof(double))}, kept.owner());
}

/// Returns a vector of the last tick; zero before the first.
template <class Member>
py::array last_tick(const HandOf& hand, const Member& member) {
  const TickLists::List list = ticks_of(hand);
  const Kept<Vec3> kept(list->empty() ? Vec3(Vec3::Zero()) : member(list->back()));
  return rows(kept.get().data(), 3, kept.owner());
}

const Vec3& force_of(const loop::TickRecord& tick) { return tick.device.force; }
const Vec3& torque_of(const loop::TickRecord& tick) { return tick.device.moment; }

}  // namespace

py::array last_force(const HandOf& hand) { return last_tick(hand, force_of); }
py::array last_torque(const HandOf& hand) { return last_tick(hand, torque_of); }

void bind_hand(py::module_& module) {
  py::class_<HandOf>(module, "Hand", "Motion of one hand and force on it so far, one row per tick.")
      .def_readonly("name", &HandOf::name)
      .def_property_readonly(
          "start_position",
          [](const HandOf& self) {
            const Simulation::Lease lease(*self.simulation);
            const Kept<Vec3> kept(
                scene::hands_of(self.simulation->world().description)[self.index].tool->position_m);
            return rows(kept.get().data(), 3, kept.owner());
          },
          "Position of the tool at the start, (3,) [m]; with start = \"touching\", where it touches.")
      .def_property_readonly(
          "times",
          [](const HandOf& self) {
            return tick_rows(
                self, [](const loop::TickRecord& tick) { return &tick.time; }, 0);
          },
          "Time at the end of each tick, (t,) [s].")
      .def_property_readonly(
          "forces",
          [](const HandOf& self) {
            return tick_rows(self, [](const loop::TickRecord& tick) { return force_of(tick).data(); });
          },
          "Forces on the hand, as rendered by the device, (t, 3) [N].")
      .def_property_readonly(
          "torques",
          [](const HandOf& self) {
            return tick_rows(self, [](const loop::TickRecord& tick) { return torque_of(tick).data(); });
          },
          "Torques on the hand, (t, 3) [N m].")
      .def_property_readonly(
          "handle_positions",
          [](const HandOf& self) {
            return tick_rows(self,
                             [](const loop::TickRecord& tick) { return tick.handle.translation.data(); });
          },
          "Positions of the handle, (t, 3) [m].")
      .def_property_readonly(
          "tool_positions",
          [](const HandOf& self) {
            return tick_rows(self, [](const loop::TickRecord& tick) { return tick.tool.translation.data(); });
          },
          "Positions of the tool's origin, (t, 3) [m].")
      .def_property_readonly("force", &last_force, "Force at the last tick, (3,) [N]; zero before the first.")
      .def_property_readonly("torque", &last_torque,
                             "Torque at the last tick, (3,) [N m]; zero before the first.")
      .def("__repr__",
           [](const HandOf& self) {
             return fmt::format("<palpate.Hand \"{}\" of {} ticks>", self.name, ticks_of(self)->size());
           })
      .def("__len__", [](const HandOf& self) { return ticks_of(self)->size(); });
}

}  // namespace palpate::python
