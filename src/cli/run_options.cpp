#include <CLI/CLI.hpp>
#include <memory>

#include "cli/missing_outputs.h"
#include "cli/option_checks.h"
#include "cli/program.h"
#include "commands.h"
#include "run.h"
#include "scene_options.h"

namespace palpate::cli {
namespace {

constexpr const char* kRunExamples = R"(Examples:
  palpate run falling-ball
  palpate run press-ball --integrator linearly-implicit-euler --set integrator.step_s=0.002
  palpate run press-ball --set body.0.youngs_modulus_pa=2e4 --picture --report -o out/softer
  palpate run two-heads --checkpoint-every 0.1 -o out/heads   loses at most 0.1 s if killed
  palpate run falling-ball --trace --report      rejected steps, with reason and location
  palpate run touch-human --realtime             lateness of its ticks on this machine
  palpate run touch-human --realtime --duration inf       until Ctrl-C, files complete
  palpate run press-ball --against-monolithic    error of its force
  palpate run two-heads --contact-picture        contact regions, depths and proxies
  palpate run press-ball --movie press.png --slow 4       a quarter of the speed; browsers play it
  palpate run touch-head --movie touch.mp4 --size 640x580
  palpate run touch-head --picture --view left --zoom 2
  palpate run touch-head --frames --frames-per-s 50 --shade penetration

Writes into the output folder: run.vtkhdf (states as a time series: ParaView 5.12, h5py), run.xdmf (the same
for older ParaViews: it points into run.vtkhdf), force.csv (force and torque on the hand), summary.json
(versions, options, counts, timings).  Ctrl-C ends the run; the data recorded until then are complete.  For
other programs see `palpate export`.

Movies have the suffix .mp4 (H.264) or .webm (VP9), which require the Debian package ffmpeg, or .png.  For
other formats the run prints the ffmpeg command that converts --frames, with their rate:
  ffmpeg -framerate 50 -i out/touch-head/frames/%04d.png touch-head.gif
Both are drawn after the run.  Ctrl-C ends the run, and the frames up to then are drawn; a second Ctrl-C ends
the drawing.  The frames written until then, and a movie of them, are complete.)";

void add_movie_options(CLI::App& command, session::Options& options) {
  command
      .add_option("--movie", options.movie,
                  "also a movie of the run, with the force below: .mp4 or .webm (by ffmpeg), .png or .apng "
                  "(animated PNG, without ffmpeg)")
      ->type_name("FILE");
  command
      .add_option("--fps", options.fps,
                  "frames per second of playback, in whole periods of the loop; default: 25, or the nearest "
                  "possible rate")
      ->type_name("NUMBER")
      ->check(positive);
  command.add_option("--slow", options.slow, "slow the movie down by FACTOR")
      ->type_name("FACTOR")
      ->check(positive)
      ->capture_default_str();
  command
      .add_option("--size", options.size,
                  "size of frames and movie, force included [pixels]; default 960x870")
      ->type_name("WIDTHxHEIGHT");
}

void add_picture_options(CLI::App& command, session::Options& options) {
  command.add_flag(
      "--picture", options.picture,
      "also a picture at the largest force; without a tool, of the largest value of --shade (picture.png)");
  command.add_flag(
      "--contact-picture", options.contact_picture,
      "also two pictures of the largest contact force: proxies in contact, penetration of the "
      "skin and its colliding vertices (contact.png); penetration over the pixels of its deepest "
      "region (depth.png)");
  command.add_flag("--frames", options.frames,
                   "also numbered pictures over the whole run, with one camera and one range of colours, the "
                   "force below (frames/0000.png ...)");
  command
      .add_option("--frames-per-s", options.frames_per_s,
                  "frames per second of simulated time, in whole periods of the loop; default: one per "
                  "record.state_period_s, else one per period")
      ->type_name("NUMBER")
      ->check(CLI::PositiveNumber);
  add_movie_options(command, options);
  add_view(command, options.scene.overrides);
  command
      .add_option("--shade", options.shade,
                  "quantity that colours picture, frames and movie: displacement, stress or penetration")
      ->type_name("NAME")
      ->capture_default_str();
}

void add_loop_options(CLI::App& command, session::Options& options) {
  command.add_flag("--report", options.report, "also an HTML page (report.html)");
  command
      .add_option(
          "--passivity", options.passivity,
          "observe: compute the energy at the device's port from the force of its motors; control: also "
          "reduce forces that would return more energy than the hand has put in; off")
      ->type_name("MODE")
      ->check(CLI::IsMember({"observe", "control", "off"}))
      ->capture_default_str();
  command.add_flag(
      "--realtime", options.real_time,
      "ticks paced by the system clock in a separate thread; prints their lateness, and records it "
      "per tick (clock.csv; a plot in the report)");
  command.add_flag(
      "--trace", options.trace,
      "also every attempted step, and the reason for rejection (trace.csv; a plot in the report)");
  command.add_flag(
      "--against-monolithic", options.against_monolithic,
      "then also the monolithic solution (tool and bodies as one system) under the same hand, with the "
      "settings of [compare.haptic]; prints and records the error of force and torque");
  command
      .add_option(
          "--checkpoint-every", options.checkpoint_every_s,
          "simulated time between checkpoints (checkpoint.h5), from which `palpate resume` continues; the "
          "scene is assembled anew at each, and the cost is printed [s]")
      ->type_name("SECONDS")
      ->check(duration);
}

}  // namespace

void add_run(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("run", "run a scene and record its results");
  auto options = std::make_shared<session::Options>();
  add_scene(*command, options->scene, true);
  command->add_option("-o,--output", options->folder, "folder for the results; default out/SCENE")
      ->type_name("DIR");
  command
      ->add_option("--duration-s,--duration", options->duration_s,
                   "simulated time, instead of the scene's [s]; inf with --realtime: until Ctrl-C")
      ->type_name("SECONDS")
      ->check(duration_or_endless);
  add_picture_options(*command, *options);
  add_loop_options(*command, *options);
  command->footer(kRunExamples);
  command->callback([options, &invocation] {
    invocation.action = [options] {
      MissingOutputs missing;
      return missing.close(run(*options, missing));
    };
    invocation.factorises = true;
  });
}

}  // namespace palpate::cli
