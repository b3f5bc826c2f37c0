// The command line, and the help that teaches it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "cli/option_checks.h"
#include "cli/other_program.h"
#include "cli/program.h"
#include "cli/stability_options.h"
#include "commands.h"

namespace palpate::cli {
namespace {

constexpr const char* kDescription =
    "palpate renders touch: a hand moves a haptic handle, a virtual spring pulls a rigid tool after it, the "
    "tool presses into a soft body,\n"
    "and the force goes back to the hand.  Every figure has a known error, and every error its price in run "
    "time.";

constexpr const char* kExamples = R"(Examples:
  palpate demo                                   the whole of it in a minute; open out/demo/report.html
  palpate run press-ball                         a tool presses a soft ball; results in out/press-ball
  palpate run my.toml --set body.0.youngs_modulus_pa=2e4 -o out/softer
  palpate inspect press-ball                     what a scene uses, what it leaves out, how large it is
  palpate export out/press-ball --to vtu         a run as files for other programs
  palpate model liver.obj -o liver.h5            a layered model of a closed surface
  palpate compare cantilever                     error against run time, for every integrator
  palpate validate                               every case with a known answer
  palpate list integrators                       the names that scenes and --integrator know

`palpate COMMAND --help` tells more about each, `palpate help` prints the documentation.

Exit status: 0 when all that the command promises was done; 1 on an error; 3 when something of it is
missing, which the last line names; 130 after Ctrl-C.)";

/// What refuses a scene for its size asks for it (core/memory.h): here, and in processes that this one
/// starts.
void add_beyond_memory(CLI::App& command) {
  command.add_flag_callback(
      "--beyond-memory", [] { ::setenv("PALPATE_BEYOND_MEMORY", "1", 1); },
      "go on where the scene is likely to need more memory than there is");
}

void add_scene(CLI::App& command, SceneArguments& scene, bool integrator) {
  command.add_option("SCENE", scene.scene, kSceneHelp)->required();
  command
      .add_option("--set", scene.overrides,
                  "change one value of the scene: KEY=VALUE, the key dotted, tables counted from 0, the "
                  "value as in TOML")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  if (integrator)
    command
        .add_option("--integrator", scene.integrator,
                    "instead of the scene's: see `palpate list integrators`")
        ->type_name("NAME");
  add_beyond_memory(command);
}

void add_movie(CLI::App& command, RunArguments& arguments) {
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

void add_run(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("run", "run a scene and keep what it records");
  auto arguments = std::make_shared<RunArguments>();
  add_scene(*command, arguments->scene, true);
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/SCENE")
      ->type_name("DIR");
  command->add_option("--duration-s", arguments->duration_s, "simulated time, instead of the scene's [s]")
      ->type_name("SECONDS")
      ->check(duration);
  command->add_flag(
      "--picture", arguments->picture,
      "also a picture of the moment of the largest force, or of the end without a tool (picture.png)");
  command->add_flag(
      "--contact-picture", arguments->contact_picture,
      "also two pictures of the largest contact force: proxies in contact, penetration of the "
      "skin and its colliding vertices (contact.png); penetration over the pixels of its deepest "
      "region (depth.png)");
  command->add_flag(
      "--frames", arguments->frames,
      "also numbered pictures over the whole run, with one camera and one range of colours, the "
      "force beneath (frames/0000.png ...)");
  command
      ->add_option("--frames-per-s", arguments->frames_per_s,
                   "frames a second of simulated time, in whole periods of the loop; default: one a "
                   "record.state_period_s, else one a period")
      ->type_name("NUMBER")
      ->check(CLI::PositiveNumber);
  add_movie(*command, *arguments);
  command
      ->add_option("--shade", arguments->shade,
                   "what colours picture, frames and movie: displacement, stress or penetration")
      ->type_name("NAME")
      ->capture_default_str();
  command->add_flag("--report", arguments->report, "also a page to look at (report.html)");
  command
      ->add_option("--passivity", arguments->passivity,
                   "observe: the energy at the device's port, by the force that its motors hold; control: "
                   "also reduces "
                   "forces that would give back more than the hand has put in; off")
      ->type_name("MODE")
      ->check(CLI::IsMember({"observe", "control", "off"}))
      ->capture_default_str();
  command->add_flag("--realtime", arguments->real_time,
                    "ticks by the machine's clock, in a thread of their own; how late they were is printed, "
                    "and kept tick by tick (clock.csv; a plot in the report)");
  command->add_flag("--trace", arguments->trace,
                    "also every attempted step, and why it was rejected (trace.csv; a plot in the report)");
  command->add_flag("--against-monolithic", arguments->against_monolithic,
                    "then again with tool and bodies as one system, under the same hand, as [compare.haptic] "
                    "of the scene says; how far force and torque were from it is printed and kept");
  command
      ->add_option(
          "--checkpoint-every", arguments->checkpoint_every_s,
          "keep where the run is every so many simulated seconds (checkpoint.h5), for `palpate resume` "
          "to go on from; the scene is assembled anew at each, and what that costs is printed [s]")
      ->type_name("SECONDS")
      ->check(duration);
  command->footer(R"(Examples:
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
are drawn, it ends that: those written are whole, and so is a movie of them.)");
  command->callback([arguments, &invocation] {
    invocation.action = [arguments] { return run(*arguments); };
    invocation.factorises = true;
  });
}

void add_compare(CLI::App& app, Invocation& invocation) {
  CLI::App* command =
      app.add_subcommand("compare", "error against run time of every integrator on one scene or several");
  auto arguments = std::make_shared<CompareArguments>();
  command
      ->add_option("SCENE", arguments->scenes,
                   "one or several: a scene file (.toml), or the name of one that comes with palpate")
      ->required();
  command
      ->add_option("--set", arguments->overrides,
                   "change one value of every scene: KEY=VALUE, as for `palpate run`")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  add_beyond_memory(*command);
  command
      ->add_option("--integrator", arguments->integrators,
                   "only this one: a name of `palpate list integrators`, or the label of a "
                   "[[compare.ladder]]; may be given more than once")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command->add_flag(
      "--all", arguments->all,
      "every integrator that moves in time, beside those named: the default where none is named");
  command
      ->add_option("--repeats", arguments->repeats, "runs of each point at most, for the spread of its time")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--limit-s", arguments->limit_s, "CPU time of a point [s]")
      ->type_name("SECONDS")
      ->check(duration)
      ->capture_default_str();
  command
      ->add_option("--reference-limit-s", arguments->reference_limit_s,
                   "CPU time of a reference, and of its check [s]")
      ->type_name("SECONDS")
      ->check(duration)
      ->capture_default_str();
  command
      ->add_option("--linear-solver", arguments->linear_solver,
                   "of all implicit methods: a name of `palpate list linear-solvers`; best: each method's "
                   "fastest, found by trying; named: the scene's, or the method's own")
      ->type_name("NAME|best|named")
      ->capture_default_str();
  command
      ->add_option("--jobs", arguments->jobs,
                   "runs side by side, at the expense of their times; default: references on all cores, all "
                   "else alone")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--fresh", arguments->fresh, "start anew instead of continuing the study in the folder");
  command->add_flag(
      "--haptic", arguments->haptic,
      "instead, of one scene: force and torque on the hand against tool and bodies as one "
      "system, over exchange period, haptic rate, contact resolution, integrator, linearisation");
  command->add_option("--duration-s", arguments->duration_s, "simulated time, instead of the scenes' [s]")
      ->type_name("SECONDS")
      ->check(duration);
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/compare-SCENE")
      ->type_name("DIR");
  command->footer(R"(Examples:
  palpate compare cantilever
  palpate compare cantilever press-ball --limit-s 5 -o out/both
  palpate compare press-ball --repeats 1 --integrator cvode-bdf --integrator linearly-implicit-euler
  palpate compare --haptic press-ball            how far its force is from the exact one, and why

Each point is one integrator at one tolerance or step, at the scene's fixed exchange period, in a process of
its own, against a tight reference whose own error is printed.  The ladders are the scene's
[[compare.ladder]], and a default one for every other integrator, down to where the reference cannot tell
errors or --limit-s ends it.  A winner is named only where the spreads of times and rungs do not overlap.
Ctrl-C or a crash loses nothing: the same line goes on where it stopped.  Writes compare.csv, reference.json,
study.sqlite (one row a run) and report.html.

With --haptic one thing at a time differs from the scene, as its [compare.haptic] says; points run one at a
time unless --jobs is given, and have 120 s of CPU each, references 1800, unless --limit-s and
--reference-limit-s are given.  Writes haptic.csv, summary.json, study.sqlite and report.html.)");
  command->callback([arguments, command, &invocation] {
    for (const char* other : {"--all", "--linear-solver"})
      if (arguments->haptic && command->count(other) > 0) throw CLI::ExcludesError("--haptic", other);
    if (arguments->haptic && command->count("--limit-s") == 0) arguments->limit_s = 120.0;
    if (arguments->haptic && command->count("--reference-limit-s") == 0)
      arguments->reference_limit_s = 1800.0;
    invocation.action = [arguments] {
      return arguments->haptic ? compare_haptic(*arguments) : compare(*arguments);
    };
    invocation.factorises = true;
    invocation.starts_processes = true;
  });
}

void add_study_by_slurm(CLI::App& command, StudyArguments& arguments) {
  CLI::Option* slurm = command.add_flag(
      "--slurm", arguments.slurm,
      "as an array job of Slurm, whose nodes see the same folders; waits for it, then prints the same table");
  command
      .add_option("--slurm-options", arguments.slurm_options,
                  "of sbatch, for every element: \"--partition=short --time=10\"")
      ->type_name("TEXT")
      ->needs(slurm);
  command
      .add_option(
          "--chunk", arguments.chunk,
          "tasks that an element runs one after another, at least; more where the site's MaxArraySize "
          "asks for it")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str()
      ->needs(slurm);
  command.add_flag("--no-wait", arguments.no_wait, "submit, and return at once")->needs(slurm);
}

void add_study(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand(
      "study", "many runs: scenes x integrators x tolerances x parameters x seeds, on all cores or by Slurm");
  auto arguments = std::make_shared<StudyArguments>();
  command->add_option("STUDY", arguments->study, "a study file (.toml): see `palpate help studies`")
      ->required();
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/study-STUDY")
      ->type_name("DIR");
  command
      ->add_option("--jobs", arguments->jobs,
                   "tasks side by side; default: as many as there are cores for their threads")
      ->check(CLI::Range(1, 1024));
  CLI::Option* dry =
      command->add_flag("--dry-run", arguments->dry_run, "print the list of tasks, and run none");
  CLI::Option* merge = command
                           ->add_flag("--merge", arguments->merge,
                                      "make the table of the results that there are, and run nothing")
                           ->excludes(dry);
  CLI::Option* fresh = command
                           ->add_flag("--fresh", arguments->fresh,
                                      "start anew instead of keeping what earlier calls have finished")
                           ->excludes(dry)
                           ->excludes(merge);
  command
      ->add_option("--task", arguments->tasks,
                   "only these tasks, and no table, as an element of an array job does: 0-3,7")
      ->type_name("LIST")
      ->excludes(dry)
      ->excludes(merge)
      ->excludes(fresh);
  command
      ->add_option("--plan", arguments->plan,
                   "refuse to run where the list of tasks has not this key: an array job says it, so that a "
                   "study which was changed since is not taken for the one that was submitted")
      ->type_name("KEY");
  add_study_by_slurm(*command, *arguments);
  command->footer(R"(Examples:
  palpate study stiffness.toml --dry-run         which tasks there are
  palpate study stiffness.toml -o out/stiffness
  palpate study stiffness.toml -o out/stiffness --slurm --slurm-options "--partition=short --time=10"
  palpate study stiffness.toml -o out/stiffness --merge

Each task runs in a process of its own under the study's limit_s, and leaves one file, DIR/tasks/KEY.json.
The same command again runs only what has none: after Ctrl-C, a crash, a node that was lost.

Writes study.csv (the same bytes whichever way it was run), study-times.csv (times and machines),
summary.json and report.html.  Exit status 0 when every task has a result, whatever it is; 3 when results are
missing.)");
  command->callback([arguments, &invocation] {
    if (arguments->slurm && (arguments->dry_run || arguments->merge || !arguments->tasks.empty()))
      throw CLI::ExcludesError("--slurm", "--dry-run, --merge and --task");
    invocation.action = [arguments] { return study(*arguments); };
    invocation.factorises = true;
    invocation.starts_processes = true;
  });
}

void add_modes(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("modes", "frequencies and shapes of a scene's free vibrations");
  auto arguments = std::make_shared<ModesArguments>();
  add_scene(*command, arguments->scene, false);
  command->add_option("--count", arguments->count, "how many, from the lowest")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--picture", arguments->picture,
                    "also a picture of the first six that are no rigid motions (modes.png)");
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/modes-SCENE")
      ->type_name("DIR");
  command->footer(R"(Examples:
  palpate modes cantilever
  palpate modes cantilever --count 20 --picture -o out/modes
  palpate modes press-ball --set body.0.youngs_modulus_pa=2e4

Solves K phi = w^2 M phi at the scene's start, damping left out; a free body begins with six rigid motions,
0 Hz.  Writes modes.csv, and modes.vtkhdf: ParaView opens it as a time series in which time is the mode's
number, step by step the displaced shapes.)");
  command->callback([arguments, &invocation] {
    invocation.action = [arguments] { return modes(*arguments); };
    invocation.factorises = true;
  });
}

void add_stability_of_loop_or_matrix(CLI::App& app, Invocation& invocation) {
  add_stability(app, [&invocation](const std::shared_ptr<StabilityArguments>& arguments) {
    if (arguments->haptic) {
      invocation.action = [arguments] { return stability_haptic(*arguments); };
      invocation.factorises = true;
    } else {
      invocation.action = [words = invocation.words] { return start(kStability, words); };
    }
  });
}

void add_resume(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("resume", "go on with a run that was stopped or killed");
  auto arguments = std::make_shared<ResumeArguments>();
  command->add_option("run", arguments->run, "folder of a run, with checkpoint.h5 in it")
      ->required()
      ->type_name("DIR");
  command->footer(R"(Examples:
  palpate run two-heads --checkpoint-every 0.1 -o out/heads
  palpate resume out/heads                       after Ctrl-C, a kill, or a loss of power

The run goes on from its last checkpoint with the options that it was started with, and ends as if it had
never stopped: all that it records is the same to the last bit.  What was recorded after the checkpoint is
cut off, and computed again.  Needs the same version of palpate, scene and meshes.  Exit status 0 where the
run is complete already.)");
  command->callback([arguments, &invocation] {
    invocation.action = [arguments] { return resume(*arguments); };
    invocation.factorises = true;
  });
}

void add_replay(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("replay", "feel the motion of a run again");
  auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("run", arguments->run, "folder of a run, with haptic.h5 in it")
      ->required()
      ->type_name("DIR");
  command->add_option("--set", arguments->overrides, "change a key of its scene (KEY=VALUE, repeatable)")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--integrator", arguments->integrator, "another integrator than the run's")
      ->type_name("NAME");
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/replay-SCENE")
      ->type_name("DIR");
  command->footer(R"(Examples:
  palpate replay out/press-ball                  each tick from its recorded input and exchange, bit for bit
  palpate replay out/press-ball --integrator cvode-bdf --set exchange.scheme=monolithic
  palpate replay out/press-ball --set exchange.exchange_period_s=0.02

Without a change nothing but the ticks is computed again: what comes out must be what was recorded, of a
run in real time as well; else the exit status is 1.  With a change the whole scene runs again in virtual
time, under the hand as it was recorded, and what a hand would feel of the difference is printed.)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return replay(*arguments); }; });
}

void add_movie(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("movie", "a movie of a run that is over");
  auto arguments = std::make_shared<MovieArguments>();
  command->add_option("run", arguments->run, "folder of a run, with run.vtkhdf in it")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("-o,--output", arguments->file, "the movie (.webm, .png or .apng); default DIR/movie.png")
      ->type_name("FILE");
  command->add_option("--fps", arguments->fps, "frames a second as it is played; default 25 at most")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  command->add_option("--slow", arguments->slow, "so many times slower than the run")
      ->type_name("FACTOR")
      ->check(CLI::PositiveNumber);
  command->add_option("--size", arguments->size, "of a frame in pixels")->type_name("WIDTHxHEIGHT");
  command->add_option("--shade", arguments->shade, "what colours the bodies: displacement or stress")
      ->type_name("NAME")
      ->check(CLI::IsMember({"displacement", "stress", "penetration"}));
  command->footer(R"(Examples:
  palpate movie out/press-ball
  palpate movie out/press-ball --slow 4 --shade stress -o touch.webm

It shows the states that the run kept (record.state_period_s), also of one that was cut off, with the force on
the hand beneath, and computes nothing anew.)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return movie(*arguments); }; });
}

void add_export(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("export", "a run that is over, as files for other programs");
  auto arguments = std::make_shared<ExportArguments>();
  command->add_option("run", arguments->run, "folder of a run, with run.vtkhdf in it; or such a file")
      ->required()
      ->type_name("DIR");
  command->add_option("--to", arguments->to, "vtu, obj, ply, csv or gltf")->required()->type_name("FORMAT");
  command->add_option("-o,--output", arguments->folder, "folder for the files; default DIR/FORMAT")
      ->type_name("DIR");
  command->add_option("--body", arguments->body, "only this body, tool or bone")->type_name("NAME");
  CLI::Option* at =
      command->add_option("--at", arguments->at_s, "only the recorded state nearest to this time [s]")
          ->type_name("SECONDS");
  CLI::Option* step = command->add_option("--step", arguments->step, "only this recorded state, from 0")
                          ->type_name("N")
                          ->excludes(at);
  command->add_option("--every", arguments->every, "each Nth recorded state, beginning with the first")
      ->type_name("N")
      ->check(CLI::Range(1, 1000000000))
      ->excludes(at)
      ->excludes(step);
  command->add_flag("--no-skin", arguments->no_skin,
                    "obj, ply, gltf: the surfaces of the tetrahedra instead of skins; the run file suffices");
  command->footer(R"(Examples:
  palpate export out/press-ball --to vtu                     run_0000.vtu ..., and run.pvd for ParaView
  palpate export out/press-ball --to ply --at 0.12           the surface, coloured by displacement
  palpate export out/press-ball --to obj --body ball --every 10 -o shapes
  palpate export out/press-ball --to csv                     nodes.csv, and the run's own tables
  palpate export out/two-heads --to gltf                     run.glb, an animation for browsers

Every recorded state, unless --at, --step or --every says otherwise.  Metres, seconds, pascals.
  vtu   tetrahedra and tools with displacement, velocity and stress
  obj   skins, or the surfaces of tetrahedra where there are none, and tools: a file a state
  ply   the same with displacement, stress and colours, one range of colours for all states
  csv   a row a node and state
  gltf  the surfaces as one animated .glb of at most 100 states, thinned evenly where the run has more
Files get their names when all are whole; after an error or Ctrl-C nothing is left.)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return export_run(*arguments); }; });
}

void add_diff(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("diff", "what a hand would feel of the difference of two runs");
  auto arguments = std::make_shared<DiffArguments>();
  command->add_option("reference", arguments->reference, "folder of a run, with haptic.h5 in it")
      ->required()
      ->type_name("DIR");
  command->add_option("other", arguments->other, "folder of another")->required()->type_name("DIR");
  command->footer(R"(Examples:
  palpate diff out/press-ball out/replay-press-ball

Forces and torques on the hand at the reference's ticks: root mean square and largest difference, its
spectrum in bands, and in how many ticks it is more than fingers notice (7 % of a force, 12.7 % of a
torque).)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return diff(*arguments); }; });
}

void add_report(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("report", "one HTML page of any results");
  auto arguments = std::make_shared<ReportArguments>();
  command
      ->add_option("folders", arguments->folders,
                   "folders that run, compare, study, validate, stability or bench wrote, in any mix")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("-o,--output", arguments->file,
                   "the page; default report.html, in the folder where only one is given")
      ->type_name("FILE");
  command->footer(R"(Examples:
  palpate report out/press-ball
  palpate report out/press-ball out/compare-press-ball out/stability -o out/report.html

The page needs no other file and no network.  It says in words first what each result answers; its tables
sort, its charts zoom and tell their values, and a run's bodies turn and play (decimated, at most 4 MB).)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return report(*arguments); }; });
}

void add_inspect(CLI::App& app, Invocation& invocation) {
  CLI::App* command =
      app.add_subcommand("inspect", "what a scene uses, what it leaves out, sizes and memory");
  auto arguments = std::make_shared<InspectArguments>();
  add_scene(*command, arguments->scene, true);
  command->footer(R"(Examples:
  palpate inspect press-ball
  palpate inspect my.toml --set body.0.mesh.element_size_m=0.005      how large would it be?)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return inspect(*arguments); }; });
}

void add_list(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("list", "the names that scenes and options know");
  auto arguments = std::make_shared<ListArguments>();
  command->add_option(
      "WHAT", arguments->what,
      "integrators, linear-solvers, materials, tool-integrators, obstacles, contact-methods, "
      "contact-springs, contact-laws, generators, devices, device-profiles, motions, parts, cases, scenes; "
      "all of these without it; or keys: every key of a scene with its unit, range, default and meaning; or "
      "study-keys: likewise of a study");
  command->add_flag(
      "--markdown", arguments->markdown,
      "as a page of the documentation: docs/keys.md with keys, docs/study-keys.md with study-keys, "
      "docs/names.md without WHAT");
  command->footer(R"(Examples:
  palpate list
  palpate list integrators
  palpate list keys)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return list(*arguments); }; });
}

void add_help(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("help", "the documentation, page by page");
  auto arguments = std::make_shared<HelpArguments>();
  command->add_option(
      "TOPIC", arguments->topic,
      "a page, or a command, whose options it then prints; without it: which pages there are");
  command->add_flag("--markdown", arguments->markdown,
                    "the page as it is written, not filled to the terminal");
  command->footer(R"(Examples:
  palpate help
  palpate help first-touch
  palpate help keys)");
  command->callback([arguments, &app, &invocation] {
    for (const CLI::App* one : app.get_subcommands({})) arguments->commands.push_back(one->get_name());
    const bool is_command =
        std::count(arguments->commands.begin(), arguments->commands.end(), arguments->topic);
    if (const OtherProgram* other = find_other_program(arguments->topic)) {
      invocation.action = [other, topic = arguments->topic] { return start(*other, {topic, "--help"}); };
      return;
    }
    if (is_command && !is_help_topic(arguments->topic)) {
      const std::string text = app.get_subcommand(arguments->topic)->help(app.get_name());
      invocation.action = [text] {
        fmt::print("{}", text);
        return 0;
      };
      return;
    }
    invocation.action = [arguments] { return help(*arguments); };
  });
}

void add_demo(CLI::App& app, Invocation& invocation) {
  CLI::App* command =
      app.add_subcommand("demo", "a tool presses a soft ball: picture, force curve, error and its price");
  auto arguments = std::make_shared<DemoArguments>();
  command->add_option("-o,--output", arguments->folder, "folder for the results")
      ->type_name("DIR")
      ->capture_default_str();
  command->footer(
      "Example:\n  palpate demo                                   then open out/demo/report.html");
  command->callback([arguments, &invocation] {
    invocation.action = [arguments] { return demo(*arguments); };
    invocation.factorises = true;
    invocation.starts_processes = true;
  });
}

/// Line of `palpate --help` about a command of another program, which parses its arguments.
void add_other(CLI::App& app, const OtherProgram& other) {
  app.add_subcommand(std::string(other.command), other.summary);
}

void add_commands(CLI::App& app, Invocation& invocation) {
  add_demo(app, invocation);
  add_run(app, invocation);
  add_compare(app, invocation);
  add_study(app, invocation);
  add_other(app, kValidate);
  add_modes(app, invocation);
  add_other(app, kModel);
  add_stability_of_loop_or_matrix(app, invocation);
  add_resume(app, invocation);
  add_replay(app, invocation);
  add_movie(app, invocation);
  add_export(app, invocation);
  add_diff(app, invocation);
  add_report(app, invocation);
  add_inspect(app, invocation);
  add_list(app, invocation);
  add_help(app, invocation);
  add_other(app, kBench);
}

}  // namespace

Invocation parse(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto command = std::find_if(words.begin(), words.end(),
                                    [](const std::string& word) { return !word.starts_with("-"); });
  const OtherProgram* other = command == words.end() ? nullptr : find_other_program(*command);
  if (!other) return parse_line(argc, argv, {kDescription, kExamples, add_commands});
  Invocation invocation;  // every word, --help too, is for that program
  invocation.action = [other, words] { return start(*other, words); };
  return invocation;
}

}  // namespace palpate::cli
