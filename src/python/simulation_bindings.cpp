// Bindings of Simulation.  Arrays of the state are views of the simulation's memory: they keep it alive, and
// change with the next steps.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.h"
#include "body.h"
#include "bone.h"
#include "callback_device.h"
#include "contact.h"
#include "context_of_call.h"
#include "hand.h"
#include "interrupt.h"
#include "missing_models.h"
#include "palpate/core/error.h"
#include "scene.h"
#include "session/peak_force_picture.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

using Shared = std::shared_ptr<Simulation>;

/// Runs one step without the GIL; Ctrl-C ends it after the integrator's current step.
template <class Step>
auto interruptible(Simulation& self, const Step& step) {
  const bool main = is_main_thread();
  try {
    const auto out = [&] {
      const py::gil_scoped_release release;
      const ContextOfCall context;
      const Interrupt interrupt(self.stop(), main);
      return step();
    }();
    if (main) run_due_handlers();
    return out;
  } catch (const Error&) {  // If Ctrl-C caused it, the exception of Python's handler takes precedence.
    if (main) run_due_handlers();
    throw;
  }
}

Shared make_simulation(const Scene& scene, double duration_s, const py::object& hands, bool external_forces,
                       bool energy) {
  SimulationOptions options{duration_s, callback_devices(hands, scene.description()), external_forces,
                            energy};
  const py::gil_scoped_release release;
  refuse_missing_models(scene.description());
  const ContextOfCall context;
  return std::make_shared<Simulation>(scene.description(), std::move(options));
}

py::dict energy_of(Simulation& self) {
  const Simulation::Lease lease(self);
  py::dict out;
  loop::visit_energies([&out](const char* name, double value) { out[name] = value; }, self.energy());
  return out;
}

/// Draws the present state.  The snapshot needs the World, the drawing only its surfaces.
std::filesystem::path draw_picture(Simulation& self, const std::filesystem::path& file,
                                   const std::string& shade) {
  const py::gil_scoped_release release;
  const Simulation::Lease lease(self);
  const ContextOfCall context;
  const session::Shade quantity = session::check_picture(shade, self.world().description);
  if (quantity == session::Shade::kPenetration)
    fail(
        "picture: shade = \"penetration\" needs the contact of a query; use \"displacement\" or \"stress\", "
        "or palpate.run(picture=True, shade=\"penetration\")");
  session::PeakForcePicture picture(quantity);
  if (self.ticks().hands() > 0 && !self.ticks().of(0)->empty()) picture.tick(self.ticks().of(0)->back());
  picture.period(self.world(), self.time());
  picture.save(self.world(), file.string());
  return file;
}

py::list all_bodies(const Shared& self) {
  py::list out;
  for (std::size_t i = 0; i < self->world().bodies.size(); ++i) out.append(BodyOf{self, i});
  return out;
}

py::list all_bones(const Shared& self) {
  py::list out;
  for (std::size_t i = 0; i < self->world().bones.size(); ++i) out.append(BoneOf{self, i});
  return out;
}

py::dict counters_of(Simulation& self) {
  const Simulation::Lease lease(self);
  py::dict out;
  loop::visit_counters([&out](const char* name, const auto& value) { out[name] = value; }, self.result());
  return out;
}

}  // namespace

void bind_simulation(py::module_& module) {
  py::class_<Simulation, Shared>(module, "Simulation",
                                 "A scene that is simulated in virtual time, period by period.")
      .def(py::init(&make_simulation), py::arg("scene"), py::arg("duration_s") = 0.0,
           py::arg("hands") = py::none(), py::arg("external_forces") = false, py::arg("energy") = false,
           "Assembles a scene.\n\n"
           "duration_s: 0 for the scene's.\n"
           "hands: a function that moves the first hand, or a dict of hand names and functions.  It is "
           "called\n"
           "once per tick as function(time, force, torque), with the force [N] and torque [N m] that the "
           "hand\n"
           "received at the tick before, (3,) each.  It returns the position of the handle, three numbers "
           "[m],\n"
           "or a HandlePose.\n"
           "external_forces: whether Body.apply_forces can be used.\n"
           "energy: whether the energy balance is computed in every period.")
      .def(
          "step", [](Simulation& self) { return interruptible(self, [&] { return self.step(); }); },
          "Advances by one period of the scene's loop.  Returns False at the end, without advancing.")
      .def(
          "advance",
          [](Simulation& self, double seconds) {
            interruptible(self, [&] { return self.advance(seconds), 0; });
          },
          py::arg("seconds"), "Advances by this simulated time, or to the end.")
      .def(
          "run", [](Simulation& self) { interruptible(self, [&] { return self.run(), 0; }); },
          "Advances to the end.")
      .def_property_readonly("time", &Simulation::time, "Simulated time so far [s].")
      .def_property_readonly("duration", &Simulation::duration, "Duration of the whole simulation [s].")
      .def_property_readonly("finished", &Simulation::finished)
      .def_property_readonly("bodies", &all_bodies)
      .def("body", &find_body, py::arg("name"), "The body of that name.")
      .def_property_readonly("bones", &all_bones, "All bones, in the order of the scene.")
      .def("bone", &find_bone, py::arg("name"), "The bone of that name.")
      .def_property_readonly("energy", &energy_of,
                             "Energies and works at the end of the last period [J], by the names of "
                             "energy.csv; needs energy=True.")
      .def("picture", &draw_picture, py::arg("file"), py::arg("shade") = "displacement",
           "Draws the present state to a PNG file and returns its path.  shade: \"displacement\" or "
           "\"stress\".")
      .def("hand", &find_hand, py::arg("name") = "tool",
           "Motion of a hand and force on it, by name: \"tool\" is the hand of [tool], a [[hand]] has its "
           "name.")
      .def_property_readonly(
          "force", [](const Shared& self) { return last_force(find_hand(self, "tool")); },
          "Force on the first hand at the last tick, (3,) [N].")
      .def_property_readonly(
          "torque", [](const Shared& self) { return last_torque(find_hand(self, "tool")); },
          "Torque on the first hand at the last tick, (3,) [N m].")
      .def_property_readonly("contact", &contact_of, "The present contact samples.")
      .def_property_readonly("counters", &counters_of, "Counts and times [s] of the run so far, by name.")
      .def("__repr__", [](const Simulation& self) {
        return fmt::format("<palpate.Simulation at {:g} of {:g} s>", self.time(), self.duration());
      });
}

}  // namespace palpate::python
