// Extension module palpate._palpate.  Users import the package around it (palpate/__init__.py).
#include "bindings.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "simulation.h"

namespace py = pybind11;
using namespace palpate;

PYBIND11_MODULE(_palpate, module) {
  log::configure(false, false);
  module.doc() = "Scenes, simulations and studies of palpate; SI units, arrays with one row per point.";
  py::register_exception<Error>(module, "Error", PyExc_ValueError).doc() =
      "A scene, a name or a value is invalid; the message says what is wrong, where, and what to do.";
  py::register_exception<python::StepFailure>(module, "IntegratorError", PyExc_RuntimeError).doc() =
      "An integrator failed; the state is the last valid one.";
  python::bind_scene(module);
  python::bind_body(module);
  python::bind_body_state(module);
  python::bind_bone(module);
  python::bind_handle_pose(module);
  python::bind_hand(module);
  python::bind_contact(module);
  python::bind_simulation(module);
  python::bind_runs(module);
  python::bind_studies(module);
}
