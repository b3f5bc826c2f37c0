#include "run.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "cli/missing_outputs.h"
#include "cli/progress.h"
#include "cli/scene_of.h"
#include "cli/stop.h"
#include "palpate/core/error.h"
#include "print_run.h"
#include "session/run_session.h"

namespace palpate::cli {
namespace {

session::Callbacks callbacks_to_terminal() {
  session::Callbacks out;
  out.stop = &stop_flag();
  out.waiting = [](const std::string& awaited) {
    fmt::print("waiting for {}\n", awaited);
    std::fflush(stdout);
  };
  return out;
}

/// Calls one step of a run while a line on the terminal shows its progress.
void with_progress(const std::string& what, session::RunSession& run,
                   void (session::RunSession::*step)(const session::Callbacks&)) {
  Progress progress(what);
  session::Callbacks callbacks = callbacks_to_terminal();
  callbacks.progress = [&progress](double fraction) { progress(fraction); };
  (run.*step)(callbacks);
}

int run_to_end(const session::Options& options, const scene::Description& description,
               MissingOutputs& missing, session::Resumption* resumption) {
  using session::RunSession;
  RunSession run(options, description, resumption);
  if (std::isinf(options.duration_s)) {
    fmt::print("{}: runs until Ctrl-C\n", short_name(description));
    std::fflush(stdout);
    run.simulate(callbacks_to_terminal());
  } else {
    with_progress("running " + short_name(description), run, &RunSession::simulate);
  }
  print_outcome(run.world(), run.output(), options);
  with_progress("computing the reference", run, &RunSession::compare_with_references);
  print_against_references(run.world(), run.output());
  run.write_results();
  print_files(run.world(), run.output());
  with_progress("drawing frames", run, &RunSession::draw_frames);
  if (run.output().frames) print_frames(*run.output().frames);
  if (const std::string why = run.failure(); !why.empty()) fail("{}", why);
  missing.add(run.output().missing);
  return print_stop(run.output()) ? kExitStopped : 0;
}

}  // namespace

int run(const session::Options& options, MissingOutputs& missing) {
  return run_to_end(options, scene_of(options.scene), missing, nullptr);
}

int resume_run(session::Resumption& resumption, const scene::Description& description,
               MissingOutputs& missing) {
  return run_to_end(resumption.identity.options, description, missing, &resumption);
}

}  // namespace palpate::cli
