// Bindings of runs with files (session/run_session.h); palpate/_run.py makes the public functions of them.
#include <pybind11/stl.h>

#include <atomic>
#include <memory>

#include "bindings.h"
#include "callback_device.h"
#include "context_of_call.h"
#include "interrupt.h"
#include "missing_models.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "palpate/loop/load.h"
#include "scene.h"
#include "session/recorded_movie.h"
#include "session/recorded_scene.h"
#include "session/run_files.h"
#include "session/run_session.h"
#include "simulation.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

/// Right of one thread to run a scene: counters and kept warnings are those of the process.
class RunOfProcess {
 public:
  RunOfProcess() {
    if (busy.exchange(true))
      fail("another thread of this process is running a scene; wait until it has ended");
    log::forget_warnings();
  }
  ~RunOfProcess() { busy = false; }
  RunOfProcess(const RunOfProcess&) = delete;
  RunOfProcess& operator=(const RunOfProcess&) = delete;

 private:
  static inline std::atomic<bool> busy{false};
};

/// Calls `work` without the GIL. Ctrl-C sets its stop flag; afterwards Python's handler is run.
template <class Work>
void without_gil(const Work& work) {
  std::atomic<bool> stop{false};
  session::Callbacks callbacks;
  callbacks.stop = &stop;
  const bool main = is_main_thread();
  try {
    const py::gil_scoped_release release;
    const Interrupt interrupt(stop, main);
    work(callbacks);
  } catch (const Error&) {  // if Ctrl-C caused it, the exception of Python's handler takes precedence
    if (main) run_due_handlers();
    throw;
  }
  if (main) run_due_handlers();
}

py::dict result_of(const std::string& folder, const store::Summary& summary, std::vector<std::string> files,
                   const std::vector<std::string>& missing) {
  py::dict out;
  out["folder"] = folder;
  out["summary"] = store::to_json(summary);
  out["files"] = std::move(files);
  out["missing"] = missing;
  return out;
}

/// Returns the paths of the files that a run has written.
std::vector<std::string> files_of(const scene::Description& description, const std::string& folder) {
  std::vector<std::string> out;
  if (folder.empty()) return out;
  for (const std::string& name : session::run_files(description, folder)) out.push_back(folder + "/" + name);
  return out;
}

py::dict run_to_end(const session::Options& options, const scene::Description& description,
                    session::Resumption* resumption, const py::object& hands = py::none()) {
  refuse_missing_models(description);
  const RunOfProcess right;
  const ContextOfCall context;
  std::vector<std::unique_ptr<device::Device>> devices = callback_devices(hands, description);
  std::unique_ptr<session::RunSession> run;
  without_gil([&](const session::Callbacks& callbacks) {
    run = std::make_unique<session::RunSession>(options, description, resumption,
                                                session::RunAttachments{std::move(devices), {}, nullptr});
    run->simulate(callbacks);
    run->compare_with_references(callbacks);
    run->write_results();
    if (!run->output().result.stopped) run->draw_frames(callbacks);  // Ctrl-C returns without delay
  });
  if (const std::string why = run->failure(); !why.empty()) throw StepFailure(why);
  const session::RunOutput& output = run->output();
  std::vector<std::string> files = files_of(run->world().description, output.folder);
  if (output.frames && output.frames->in_folder > 0) files.push_back(output.frames->folder);
  if (output.frames && output.frames->in_movie > 0) files.push_back(output.frames->movie);
  return result_of(output.folder, run->summary(), std::move(files), output.missing.outputs());
}

py::dict run(const Scene& scene, session::Options options, const py::object& hands) {
  options.scene = {scene.is_from_file() ? scene.description().path : "", scene.changes(), ""};
  return run_to_end(options, scene.description(), nullptr, hands);
}

py::dict resume(const std::string& folder) {
  if (session::is_finished_run(folder)) {
    const store::Summary summary = store::read_summary(folder + "/summary.json");
    return result_of(folder, summary, files_of(session::recorded_scene(summary.scene_source, folder), folder),
                     {});
  }
  session::Resumption resumption = session::read_resumption(folder);
  for (const std::string& line : session::processor_differences(resumption))
    if (PyErr_WarnEx(PyExc_RuntimeWarning, line.c_str(), 1) != 0) throw py::error_already_set();
  const scene::Description description = session::scene_to_resume(
      resumption,
      [](const scene::SceneArguments& scene) { return loop::load(scene.scene, scene.changes()); });
  return run_to_end(resumption.identity.options, description, &resumption);
}

std::string movie(const session::MovieOptions& options) {
  const ContextOfCall context;
  MissingOutputs missing;
  session::DrawnFrames drawn;
  without_gil([&](const session::Callbacks& callbacks) {
    drawn = session::draw_recorded_movie(
        options,
        [](const std::string& text, const std::filesystem::path& folder) {
          const scene::Description description = session::recorded_scene(text, folder);
          refuse_missing_models(description);
          return description;
        },
        callbacks, missing);
  });
  if (!missing.empty()) fail("missing {}", missing.outputs().front());
  return drawn.movie;
}

}  // namespace

void bind_runs(py::module_& module) {
  using Options = session::Options;
  py::class_<Options>(module, "_RunOptions")
      .def(py::init<>())
      .def_readwrite("folder", &Options::folder)
      .def_readwrite("duration_s", &Options::duration_s)
      .def_readwrite("picture", &Options::picture)
      .def_readwrite("contact_picture", &Options::contact_picture)
      .def_readwrite("frames", &Options::frames)
      .def_readwrite("frames_per_s", &Options::frames_per_s)
      .def_readwrite("movie", &Options::movie)
      .def_readwrite("fps", &Options::fps)
      .def_readwrite("slow", &Options::slow)
      .def_readwrite("size", &Options::size)
      .def_readwrite("shade", &Options::shade)
      .def_readwrite("report", &Options::report)
      .def_readwrite("trace", &Options::trace)
      .def_readwrite("passivity", &Options::passivity)
      .def_readwrite("real_time", &Options::real_time)
      .def_readwrite("against_monolithic", &Options::against_monolithic)
      .def_readwrite("checkpoint_every_s", &Options::checkpoint_every_s);
  module.def("_run", &run, py::arg("scene"), py::arg("options"), py::arg("hands") = py::none());
  module.def("_resume", &resume, py::arg("folder"));
  module.def(
      "_movie",
      [](const std::string& run, const std::string& file, double fps, double slow, const std::string& size,
         const std::string& shade) {
        return movie({run, file, fps, slow, size, shade});
      },
      py::arg("run"), py::arg("file"), py::arg("fps"), py::arg("slow"), py::arg("size"), py::arg("shade"));
}

}  // namespace palpate::python
