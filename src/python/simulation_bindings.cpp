// Bindings of Simulation.  Arrays of the state are views of the simulation's memory: they keep it alive, and
// change with the next steps.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include "bindings.h"
#include "body.h"
#include "contact.h"
#include "context_of_call.h"
#include "hand.h"
#include "interrupt.h"
#include "missing_models.h"
#include "palpate/core/error.h"
#include "scene.h"

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

Shared make_simulation(const Scene& scene, double duration_s) {
  const py::gil_scoped_release release;
  refuse_missing_models(scene.description());
  const ContextOfCall context;
  return std::make_shared<Simulation>(scene.description(), duration_s);
}

py::list all_bodies(const Shared& self) {
  py::list out;
  for (std::size_t i = 0; i < self->world().bodies.size(); ++i) out.append(BodyOf{self, i});
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
           "Assembles a scene.  duration_s: 0 for the scene's.")
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
