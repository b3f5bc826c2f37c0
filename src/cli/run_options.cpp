#include <CLI/CLI.hpp>
#include <memory>

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
  palpate run two-heads --checkpoint-every 0.1 -o out/heads   a kill costs 0.1 s of it at most
  palpate run falling-ball --trace --report      which steps were rejected, why, and where
  palpate run touch-human --realtime             how late its ticks are on this machine
  palpate run press-ball --against-monolithic    how far its force is from the exact one
  palpate run two-heads --contact-picture        what touches where, how deep, by which proxies
  palpate run press-ball --movie press.png --slow 4       a quarter of its speed; browsers play it
  palpate run touch-head --movie touch.webm --size 640x580
  palpate run touch-head --frames --frames-per-s 50 --shade penetration

Writes into the output folder: run.vtkhdf (states as a time series: ParaView 5.12, h5py), run.xdmf (the same
for older ParaViews: it points into run.vtkhdf), force.csv (force and torque on the hand), summary.json
(versions, options, counts, timings).  Ctrl-C ends the run; what was recorded by then is whole.  For other
programs see `palpate export`.

Movies end in .webm, which takes the Debian package ffmpeg, or in .png; for other kinds the run prints how
ffmpeg makes one of --frames, with its own rate:
  ffmpeg -framerate 50 -i out/touch-head/frames/%04d.png -pix_fmt yuv420p touch-head.mp4
Both are drawn behind the run.  Ctrl-C ends the run, and what it reached is drawn; once more, or while frames
are drawn, it ends that: those written are whole, and so is a movie of them.)";

void add_movie_options(CLI::App& command, RunArguments& arguments) {
  command
      .add_option(
          "--movie", arguments.movie,
          "also a movie of the run, with the force beneath: .webm (by ffmpeg), .png or .apng (animated "
          "PNG, without it)")
      ->type_name("FILE");
  command
      .add_option(
          "--fps", arguments.fps,
          "frames a second of the movie as it is played, in whole periods of the loop; default: 25, or "
          "what these allow")
      ->type_name("NUMBER")
      ->check(positive);
  command.add_option("--slow", arguments.slow, "the movie takes FACTOR times as long as what it shows")
      ->type_name("FACTOR")
      ->check(positive)
      ->capture_default_str();
  command
      .add_option("--size", arguments.size, "of frames and movie, force included [pixels]; default 960x870")
      ->type_name("WIDTHxHEIGHT");
}

void add_picture_options(CLI::App& command, RunArguments& arguments) {
  command.add_flag(
      "--picture", arguments.picture,
      "also a picture of the moment of the largest force, or of the end without a tool (picture.png)");
  command.add_flag(
      "--contact-picture", arguments.contact_picture,
      "also two pictures of the largest contact force: proxies in contact, penetration of the "
      "skin and its colliding vertices (contact.png); penetration over the pixels of its deepest "
      "region (depth.png)");
  command.add_flag("--frames", arguments.frames,
                   "also numbered pictures over the whole run, with one camera and one range of colours, the "
                   "force beneath (frames/0000.png ...)");
  command
      .add_option("--frames-per-s", arguments.frames_per_s,
                  "frames a second of simulated time, in whole periods of the loop; default: one a "
                  "record.state_period_s, else one a period")
      ->type_name("NUMBER")
      ->check(CLI::PositiveNumber);
  add_movie_options(command, arguments);
  command
      .add_option("--shade", arguments.shade,
                  "what colours picture, frames and movie: displacement, stress or penetration")
      ->type_name("NAME")
      ->capture_default_str();
}

void add_loop_options(CLI::App& command, RunArguments& arguments) {
  command.add_flag("--report", arguments.report, "also a page to look at (report.html)");
  command
      .add_option("--passivity", arguments.passivity,
                  "observe: the energy at the device's port, by the force that its motors hold; control: "
                  "also reduces "
                  "forces that would give back more than the hand has put in; off")
      ->type_name("MODE")
      ->check(CLI::IsMember({"observe", "control", "off"}))
      ->capture_default_str();
  command.add_flag("--realtime", arguments.real_time,
                   "ticks by the machine's clock, in a thread of their own; how late they were is printed, "
                   "and kept tick by tick (clock.csv; a plot in the report)");
  command.add_flag("--trace", arguments.trace,
                   "also every attempted step, and why it was rejected (trace.csv; a plot in the report)");
  command.add_flag("--against-monolithic", arguments.against_monolithic,
                   "then again with tool and bodies as one system, under the same hand, as [compare.haptic] "
                   "of the scene says; how far force and torque were from it is printed and kept");
  command
      .add_option(
          "--checkpoint-every", arguments.checkpoint_every_s,
          "keep where the run is every so many simulated seconds (checkpoint.h5), for `palpate resume` "
          "to go on from; the scene is assembled anew at each, and what that costs is printed [s]")
      ->type_name("SECONDS")
      ->check(duration);
}

}  // namespace

void add_run(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("run", "run a scene and keep what it records");
  auto arguments = std::make_shared<RunArguments>();
  add_scene(*command, arguments->scene, true);
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/SCENE")
      ->type_name("DIR");
  command->add_option("--duration-s", arguments->duration_s, "simulated time, instead of the scene's [s]")
      ->type_name("SECONDS")
      ->check(duration);
  add_picture_options(*command, *arguments);
  add_loop_options(*command, *arguments);
  command->footer(kRunExamples);
  command->callback([arguments, &invocation] {
    invocation.action = [arguments] { return run(*arguments); };
    invocation.factorises = true;
  });
}

}  // namespace palpate::cli
