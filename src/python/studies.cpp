// Bindings of integrator comparisons and of validation cases with known solutions.
#include <pybind11/stl.h>

#include <atomic>

#include "bindings.h"
#include "interrupt.h"
#include "missing_models.h"
#include "palpate/core/error.h"
#include "palpate/experiments/compare.h"
#include "scene.h"
#include "validation.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

/// Writes the files of a comparison into `folder`; returns the figures that are in none of them.
/// @pre this process has no other thread, or has prepared a pool of processes (core/process_pool.h)
py::dict compare_into(const std::string& folder, const Scene& scene,
                      const std::vector<std::string>& integrators, double limit_s, double reference_limit_s,
                      int repeats, int jobs, const std::string& linear_solver) {
  refuse_missing_models(scene.description());
  std::atomic<bool> stop{false};
  compare::CompareOptions options;
  options.integrators = integrators;
  options.limit_s = limit_s;
  options.reference_limit_s = reference_limit_s;
  options.repeats = repeats;
  options.jobs = jobs;
  options.linear_solver = linear_solver;
  options.linear_solvers = linear_solver == "best"    ? compare::LinearSolvers::kBest
                           : linear_solver == "named" ? compare::LinearSolvers::kNamed
                                                      : compare::LinearSolvers::kSame;
  options.stop = &stop;
  const bool main = is_main_thread();
  const compare::Comparison done = [&] {
    const py::gil_scoped_release release;
    const Interrupt interrupt(stop, main);
    compare::Comparison out = compare::run({scene.description()}, options);
    compare::write(out, folder);
    return out;
  }();
  if (main) run_due_handlers();
  const compare::Reference& reference = done.scenes.front().reference;
  py::dict out;
  out["reference"] = reference.description;
  out["trouble"] = reference.trouble;
  out["reference_position_error_rel_l2"] = reference.own_error.position_rel_l2;
  out["reference_force_error_rms_n"] = reference.own_error.force_rms_n;
  out["peak_force_n"] = reference.peak_force_n;
  out["rules"] = done.rules;
  return out;
}

/// Measured quantity of a case.
struct Measured {
  std::string name;
  validation::Measurement measurement;
};

std::vector<Measured> validate(const std::vector<std::string>& names) {
  std::vector<const validation::ValidationCase*> cases;
  std::vector<std::string> known;
  for (const validation::ValidationCase& one : validation::validation_cases()) known.push_back(one.name);
  for (const std::string& name : names) {
    const auto at = std::find(known.begin(), known.end(), name);
    if (at == known.end()) fail("there is no case \"{}\"{}", name, suggestion(name, known));
    cases.push_back(&validation::validation_cases()[static_cast<std::size_t>(at - known.begin())]);
  }
  std::vector<Measured> out;
  for (const validation::ValidationCase* one : cases) {
    const auto measurements = [one] {
      const py::gil_scoped_release release;
      return one->run("");
    }();
    for (const validation::Measurement& measurement : measurements) out.push_back({one->name, measurement});
    run_due_handlers();
  }
  return out;
}

}  // namespace

void bind_studies(py::module_& module) {
  module.def("compare_into", &compare_into, py::arg("folder"), py::arg("scene"), py::arg("integrators"),
             py::arg("limit_s"), py::arg("reference_limit_s"), py::arg("repeats"), py::arg("jobs"),
             py::arg("linear_solver"));
  using M = Measured;
  py::class_<M>(module, "Measurement", "One measured quantity of a case with a known answer.")
      .def_readonly("case", &M::name)
      .def_property_readonly("quantity", [](const M& m) { return m.measurement.quantity; })
      .def_property_readonly("computed", [](const M& m) { return m.measurement.computed; })
      .def_property_readonly("exact", [](const M& m) { return m.measurement.exact; })
      .def_property_readonly("error", [](const M& m) { return m.measurement.error; })
      .def_property_readonly("bar", [](const M& m) { return m.measurement.bar; })
      .def_property_readonly("order", [](const M& m) { return m.measurement.order; })
      .def_property_readonly("passed", [](const M& m) { return m.measurement.passed(); })
      .def("__repr__", [](const M& m) {
        return "<palpate.Measurement " + m.name + ": " + m.measurement.quantity +
               (m.measurement.passed() ? ", passed>" : ", failed>");
      });
  module.def("validate", &validate, py::arg("cases"),
             "Runs cases with a known answer by name; returns a list of Measurement.");
}

}  // namespace palpate::python
