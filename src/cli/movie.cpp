#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/missing_outputs.h"
#include "cli/program.h"
#include "cli/progress.h"
#include "cli/stop.h"
#include "commands.h"
#include "print_run.h"
#include "recorded_scene.h"
#include "scene_options.h"
#include "session/recorded_movie.h"

namespace palpate::cli {
namespace {

int movie(const session::MovieOptions& options) {
  MissingOutputs missing;
  const session::DrawnFrames drawn = [&] {
    Progress progress("drawing frames");
    session::Callbacks callbacks;
    callbacks.progress = [&progress](double fraction) { progress(fraction); };
    callbacks.stop = &stop_flag();
    return session::draw_recorded_movie(
        options,
        [&options](const std::string& text, const std::filesystem::path& folder) {
          return recorded_scene(text, folder, options.overrides);
        },
        callbacks, missing);
  }();
  print_frames(drawn);
  if (!drawn.stopped) return missing.close(0);
  fmt::print(stderr, "palpate: stopped while drawing frames; those written are complete\n");
  return missing.close(kExitStopped);
}

}  // namespace

void add_movie(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("movie", "make a movie of a completed run");
  auto arguments = std::make_shared<session::MovieOptions>();
  command->add_option("run", arguments->run, "folder of a run, which contains run.vtkhdf")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("-o,--output", arguments->file,
                   "the movie (.mp4, .webm, .png or .apng); default DIR/movie.png")
      ->type_name("FILE");
  command->add_option("--fps", arguments->fps, "frames per second of playback; default at most 25")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  command->add_option("--slow", arguments->slow, "slow the movie down by FACTOR")
      ->type_name("FACTOR")
      ->check(CLI::PositiveNumber);
  command->add_option("--size", arguments->size, "size of a frame [pixels]")->type_name("WIDTHxHEIGHT");
  command->add_option("--shade", arguments->shade, "quantity that colours the bodies: displacement or stress")
      ->type_name("NAME")
      ->check(CLI::IsMember({"displacement", "stress", "penetration"}));
  add_view(*command, arguments->overrides);
  command->footer(R"(Examples:
  palpate movie out/press-ball
  palpate movie out/press-ball --slow 4 --shade stress -o touch.mp4 --view front

Shows the recorded states (record.state_period_s), also of an interrupted run, with the force on the hand
below.  Nothing is computed again.)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return movie(*arguments); }; });
}

}  // namespace palpate::cli
