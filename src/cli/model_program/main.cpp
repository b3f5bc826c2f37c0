#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>

#include "cli/guarded.h"
#include "cli/progress.h"
#include "cli/stop.h"
#include "cli/streams.h"
#include "core/clock.h"
#include "guard.h"
#include "memory_question.h"
#include "options.h"
#include "outcome.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "pictures.h"
#include "size_question.h"
#include "sources.h"
#include "store/atomic_file.h"
#include "worker.h"

namespace palpate::cli {
namespace {

/// Progress listener with one bar per step; it also sets the message of the guard for a step that exceeds the
/// time limit.
class Bars : public model::ProgressListener {
 public:
  explicit Bars(const ModelArguments& arguments) : arguments_(arguments) {
    refuse(fmt::format("{}: the model was not completed", arguments_.source), "");
  }
  void begin(const std::string& step) override {
    step_ = step;
    worker_stage(step);
    refuse(fmt::format("{}: \"{}\" did not finish", arguments_.source, step_), "");
    bar_ = std::make_unique<Progress>(step);
    (*bar_)(0.0);
  }
  void progress(double fraction) override { (*bar_)(fraction); }
  void stage(const std::string& stage) override { worker_stage(stage); }
  void point(const Vec3& at) override {
    worker_place(fmt::format("at ({:.4g}, {:.4g}, {:.4g}) m", at.x(), at.y(), at.z()));
  }
  void place(const std::string& where) override {
    worker_place(where);
    refuse(fmt::format("{}: \"{}\" did not finish", where, step_),
           ", or repair the surface there with a mesh editor");
  }
  void end(const model::Step& step) override {
    bar_.reset();
    if (arguments_.verbose) fmt::print(stderr, "palpate: {}: {:.2f} s\n", step.name, step.seconds);
  }

 private:
  void refuse(const std::string& what, const char* way_out) const {
    set_refusal(fmt::format("palpate: error: {} within {:.3g} s; raise --limit-s{}", what,
                            arguments_.options.tetrahedra.limits.seconds, way_out));
  }

  const ModelArguments& arguments_;
  std::string step_;
  std::unique_ptr<Progress> bar_;
};

/// Builds the model, writes and draws it; returns the exit status.
int make(ModelArguments& arguments, model::Input input, double seconds) {
  catch_stop();
  for (std::ostream* const stream : {&std::cout, &std::cerr, &std::clog})
    stream->rdbuf(nullptr);  // silences the output of CGAL
  Bars bars(arguments);
  constexpr double kGrace = 1.0;  // a step that detects the time limit itself gives a more precise message
  catch_time(seconds + kGrace);
  model::Made made = model::make_model(std::move(input), arguments.options, bars);
  made.file.record.options = arguments.as_given;
  {
    SignalsHeld whole_file;
    store::write_model(arguments.output_path, made.file);
    whole_file.written();
  }
  worker_stage("draw the model");
  if (!arguments.picture.empty()) draw_model(made.file.model, arguments.picture_path);
  if (!arguments.quiet) print_outcome(made, arguments.output);
  return 0;
}

[[noreturn]] void refuse(const ModelArguments& arguments, const WorkerEnd& end) {
  fail(
      "{}: the model was not completed: a library crashed in \"{}\"{} ({}); change --tetrahedra, omit "
      "creases with --creases none, or repair the surface there with a mesh editor",
      arguments.source, end.stage.empty() ? "the start" : end.stage, end.place.empty() ? "" : " " + end.place,
      end.signal);
}

int model_command(int argc, char** argv) {
  ModelArguments arguments = parse_model(argc, argv);
  if (!arguments.given) return 0;
  log::configure(arguments.quiet, arguments.verbose);
  if (!arguments.picture.empty()) check_pictures(arguments.picture);
  catch_stop();
  const model::Input input = input_of(arguments);
  if (arguments.output.empty()) arguments.output = input.name + ".h5";
  if (std::error_code none; std::filesystem::equivalent(arguments.source, arguments.output, none))
    fail("-o {}: is the source itself; choose another name", arguments.output);
  arguments.output_path = std::filesystem::absolute(arguments.output).string();
  if (!arguments.picture.empty())
    arguments.picture_path = std::filesystem::absolute(arguments.picture).string();
  store::check_can_write(arguments.output);
  if (!arguments.picture.empty()) store::check_can_write(arguments.picture);
  ask_about_size(arguments, input);
  refuse_beyond_memory(arguments, input);
  const model::Limits& limits = arguments.options.tetrahedra.limits;
  if (!arguments.quiet) {
    fmt::print("{}: at most {:g} s and {} points (--limit-s, --points)\n", input.name, limits.seconds,
               limits.points);
    std::fflush(stdout);
  }
  const double start = wall_seconds();
  const WorkerEnd end =
      run_attempts(arguments.options.tetrahedra.optimisation, [&](const model::Optimisation& optimisation) {
        arguments.options.tetrahedra.optimisation = optimisation;
        return guarded([&] { return make(arguments, input, limits.seconds - (wall_seconds() - start)); },
                       "surface");
      });
  if (!end.signal.empty()) refuse(arguments, end);
  return end.status;
}

}  // namespace
}  // namespace palpate::cli

int main(int argc, char** argv) {
  using namespace palpate::cli;
  palpate::log::configure(false, false);  // uses standard error unguarded, for its colours
  guard_streams();
  return guarded([&] { return model_command(argc, argv); }, "surface");
}
