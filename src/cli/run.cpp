#include "run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "against_monolithic.h"
#include "checkpoints.h"
#include "cli/missing_outputs.h"
#include "cli/paths.h"
#include "cli/progress.h"
#include "cli/scene_of.h"
#include "cli/stop.h"
#include "clock_figures.h"
#include "contact_picture.h"
#include "core/clock.h"
#include "core/counters.h"
#include "core/time_text.h"
#include "frames.h"
#include "loop/haptic_memory.h"
#include "loop/registries.h"
#include "loop/summary.h"
#include "loop/trace.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "palpate/loop/recorder.h"
#include "palpate/scene/hands.h"
#include "picture.h"
#include "report/run_report.h"
#include "run_files.h"
#include "run_remarks.h"
#include "store/atomic_file.h"
#include "store/provenance.h"
#include "store/result_folder.h"

namespace palpate::cli {
namespace {

/// The largest force and torque that the hand felt, and when.
class PeakWrench : public loop::Observer {
 public:
  void tick_of(std::size_t hand, const loop::TickRecord& tick) override {
    if (hand >= of.size()) of.resize(hand + 1);
    Peak& p = of[hand];
    if (tick.device.force.norm() > p.force_n) p.force_n = tick.device.force.norm(), p.force_s = tick.time;
    if (tick.device.moment.norm() > p.torque_n_m)
      p.torque_n_m = tick.device.moment.norm(), p.torque_s = tick.time;
  }
  void archive(Archive& a) override {
    a.list("peak", of, [&](Peak& p) {
      a("force_n", p.force_n);
      a("force_s", p.force_s);
      a("torque_n_m", p.torque_n_m);
      a("torque_s", p.torque_s);
    });
  }
  struct Peak {
    double force_n = 0.0, force_s = 0.0, torque_n_m = 0.0, torque_s = 0.0;
  };
  std::vector<Peak> of{1};  ///< each hand
};

void print_hand(const std::string& who, const PeakWrench::Peak& peak, long ticks, long limited) {
  fmt::print(
      "on {}: at most {:.4g} N (at {} s) and {:.4g} N m (at {} s) in {} ticks; {} held at the device's "
      "limit\n",
      who, peak.force_n, time_text(peak.force_s), peak.torque_n_m, time_text(peak.torque_s), ticks, limited);
}

/// What was asked for, and what the method makes of it.
void print_tolerance(const IntegratorSpec& spec) {
  const auto& method = find(loop::steppers(), spec.name, "integrator");
  if (method.error_test_rtol && !spec.fixed_step)
    fmt::print("{}: rtol {:g}, error test at {:.3g}\n", spec.name, spec.rtol, method.error_test_rtol(spec));
}

/// Result of one run and its cost.
struct RunOutput {
  loop::RunResult result;
  std::vector<std::string> remarks;  ///< run_remarks()
  double assemble_s = 0.0;
  PeakWrench peak;
  loop::CheckpointCost checkpoints;
};

/// The largest force and torque on each hand, as summary.json keeps them.
void add_peaks(store::Summary& summary, const scene::Description& description, const RunOutput& ran) {
  if (ran.result.ticks == 0) return;
  const std::vector<scene::Hand> hands = scene::hands_of(description);
  for (std::size_t i = 0; i < std::min(hands.size(), ran.peak.of.size()); ++i) {
    auto& values =
        summary.section(i == 0 ? "on the hand" : fmt::format("on the hand {}", hands[i].name)).values;
    const PeakWrench::Peak& peak = ran.peak.of[i];
    values.emplace_back("peak_force_n", peak.force_n);
    values.emplace_back("peak_force_at_s", peak.force_s);
    values.emplace_back("peak_torque_n_m", peak.torque_n_m);
    values.emplace_back("peak_torque_at_s", peak.torque_s);
  }
}

void print_outcome(const loop::World& world, const RunOutput& ran) {
  const loop::RunResult& result = ran.result;
  const PeakWrench& peak = ran.peak;
  fmt::print("{}: {} s simulated in {:.2f} s, assembled in {:.2f} s, peak memory {:.0f} MiB\n",
             short_name(world.description), time_text(result.time), result.wall_s, ran.assemble_s,
             peak_memory_mib());
  if (world.stepper) {
    const dynamics::StepperCounters& c = result.counters;
    fmt::print("{}: {} steps, {} force and {} tangent evaluations, {} factorisations, {} contact queries\n",
               world.stepper->name(), c.steps, c.force_evaluations, c.tangent_evaluations,
               c.solver.factorisations, result.contact_queries);
    print_tolerance(world.description.integrator);
  }
  if (result.ticks > 0) print_hand("the hand", peak.of[0], result.ticks, result.limited_ticks);
  for (std::size_t i = 0; i < result.more_hands.size() && i + 1 < peak.of.size(); ++i)
    print_hand(fmt::format("hand \"{}\"", world.description.hands[i].name), peak.of[i + 1],
               result.more_hands[i].ticks, result.more_hands[i].limited_ticks);
  if (result.real_time) print_clock(*result.real_time);
  for (const std::string& remark : ran.remarks) fmt::print("{}\n", remark);
}

/// A word of the command line, quoted where a shell would split or expand it.
std::string quoted(const std::string& word) {
  if (word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:+@%") ==
          std::string::npos &&
      !word.empty())
    return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// The command line that repeats this run.
std::string command_of(const RunArguments& a) {
  std::string out = "palpate run " + quoted(a.scene.scene);
  for (const std::string& change : a.scene.overrides) out += " --set " + quoted(change);
  if (!a.scene.integrator.empty()) out += " --integrator " + quoted(a.scene.integrator);
  if (a.duration_s > 0.0) out += fmt::format(" --duration-s {}", a.duration_s);
  if (a.picture) out += " --picture";
  if (a.contact_picture) out += " --contact-picture";
  if (a.frames) out += " --frames";
  if (a.frames && a.frames_per_s > 0.0) out += fmt::format(" --frames-per-s {}", a.frames_per_s);
  if (!a.movie.empty()) out += " --movie " + quoted(a.movie);
  if (a.fps > 0.0) out += fmt::format(" --fps {}", a.fps);
  if (a.slow != 1.0) out += fmt::format(" --slow {}", a.slow);
  if (!a.size.empty()) out += " --size " + a.size;
  if ((a.picture || a.frames || !a.movie.empty()) && a.shade != "displacement") out += " --shade " + a.shade;
  if (a.report) out += " --report";
  if (a.passivity != "off") out += " --passivity " + a.passivity;
  if (a.real_time) out += " --realtime";
  if (a.trace) out += " --trace";
  if (a.against_monolithic) out += " --against-monolithic";
  if (a.checkpoint_every_s > 0.0) out += fmt::format(" --checkpoint-every {}", a.checkpoint_every_s);
  return a.folder.empty() ? out : out + " -o " + quoted(a.folder);
}

/// How a run ended, where its result does not say it.
struct Outcome {
  std::string word, message;
};
/// Written when the run begins, so that one that is killed is known for what it is.
const Outcome kUnfinished{"unfinished",
                          "the run is in progress or was killed; data written so far are complete"};

void keep_summary(const loop::World& world, const RunOutput& ran,
                  const std::optional<compare::AgainstMonolithic>& against, const RunArguments& arguments,
                  const std::string& folder, const std::optional<Outcome>& outcome = {}) {
  store::Summary summary = loop::summarise(world, ran.result, ran.assemble_s);
  add_peaks(summary, world.description, ran);
  if (outcome) summary.outcome = outcome->word, summary.message = outcome->message;
  if (against) add_against_monolithic(summary, world.description, *against);
  if (const double every_s = arguments.checkpoint_every_s; every_s > 0.0)
    add_checkpoints(summary, ran.checkpoints, every_s);
  summary.command = command_of(arguments);
  summary.overrides = arguments.scene.overrides;
  summary.remarks = log::warnings();
  summary.remarks.insert(summary.remarks.end(), ran.remarks.begin(), ran.remarks.end());
  if (against)
    for (std::string& line : against_monolithic_remarks(world.description, *against))
      summary.remarks.push_back(std::move(line));
  store::write_summary((std::filesystem::path(folder) / "summary.json").string(), summary);
  store::write_atomically((std::filesystem::path(folder) / "scene.toml").string(), world.description.source);
}

/// How pictures are to look.
struct PictureOptions {
  Shade shade = Shade::kDisplacement;
  double between_s = 0.0;  ///< simulated time from frame to frame
  FrameSize size = {};     ///< of frames
};

/// Refuses at the start what could not be drawn at the end.
PictureOptions check_pictures(const RunArguments& arguments, const scene::Description& description) {
  if (arguments.contact_picture && description.contacts.empty())
    fail("--contact-picture: the scene has no [[contact]]");
  const bool movie = !arguments.movie.empty();
  if (arguments.frames_per_s > 0.0 && !arguments.frames) fail("--frames-per-s needs --frames");
  if (arguments.frames_per_s > 0.0 && movie)
    fail("--frames-per-s: with --movie the frames are those of the movie; use --fps and --slow instead");
  if ((arguments.fps > 0.0 || arguments.slow != 1.0) && !movie) fail("--fps and --slow need --movie");
  if (!arguments.size.empty() && !arguments.frames && !movie) fail("--size needs --frames or --movie");
  if (!arguments.picture && !arguments.contact_picture && !arguments.frames && !movie) return {};
  PictureOptions look{check_picture(arguments.shade, description)};
  if (!arguments.size.empty()) look.size = frame_size(arguments.size);
  if (movie)
    look.between_s = between_movie_frames(description, arguments.fps, arguments.slow);
  else if (arguments.frames)
    look.between_s = between_frames(description, arguments.frames_per_s);
  if (movie) check_movie(arguments.movie);
  return look;
}

void keep_picture(const loop::World& world, const Snapshot& snapshot, const std::string& folder,
                  MissingOutputs& missing) {
  const std::string path = (std::filesystem::path(folder) / "picture.png").string();
  try {
    snapshot.save(world, path);
  } catch (const Error& e) { missing.add("picture " + path, e.what()); }
}

/// Ends the files of states; the sidecar is made then.
void close_records(loop::Recorder& recorder, const std::string& folder, MissingOutputs& missing) {
  try {
    recorder.close();
  } catch (const Error& e) {
    missing.add("sidecar " + (std::filesystem::path(folder) / "run.xdmf").string(), e.what());
  }
}

/// Draws the frames, says where they are, and whether Ctrl-C has ended it.
bool keep_frames(const loop::World& world, Frames& frames, const RunArguments& arguments,
                 const std::string& folder, bool run_stopped, MissingOutputs& missing) {
  const std::string path = (std::filesystem::path(folder) / "frames").string();
  const double between_s = frames.between_s(), shown_s = between_s * arguments.slow;
  std::unique_ptr<FrameSink> pictures, movie;
  std::vector<FrameSink*> sinks;
  if (arguments.frames) sinks.push_back((pictures = make_frame_folder(path)).get());
  if (!arguments.movie.empty()) sinks.push_back((movie = make_movie(arguments.movie, shown_s)).get());
  frames.save(world, sinks, !run_stopped, missing);
  int least = frames.count();
  for (const FrameSink* sink : sinks) least = std::min(least, sink->written());
  if (pictures) {
    fmt::print("{} of {} frames in {}, one every {:g} s of simulated time; to make a movie in real time:\n",
               pictures->written(), frames.count(), path, between_s);
    fmt::print("  ffmpeg -framerate {:g} -i {}/%04d.png -pix_fmt yuv420p {}.mp4\n", 1.0 / between_s, path,
               path);
  }
  if (movie)
    fmt::print("{} of {} frames in {}, one every {:g} s of simulated time; {:.4g} per second when played\n",
               movie->written(), frames.count(), arguments.movie, between_s, 1.0 / shown_s);
  return !run_stopped && stop_flag().load() && least < frames.count();
}

/// Prints which files of this run are in the folder.
void print_files(const scene::Description& description, const std::string& folder) {
  fmt::print("in {}: {}\n", folder, fmt::join(run_files(description, folder), ", "));
  if (!description.record)
    fmt::print(
        "states{} were not written, because the scene has no [record]; --set record.states=true writes "
        "them\n",
        description.tool ? " and the force over time" : "");
}

/// @param from  where it goes on, null at its start
loop::RunResult run_with_progress(std::unique_ptr<loop::World>& world, const RunArguments& arguments,
                                  std::vector<loop::Observer*> observers,
                                  const loop::CheckpointPlan* checkpoints, loop::CheckpointCost& cost,
                                  loop::Resumed* from) {
  Progress progress(fmt::format("running {}", short_name(world->description)));
  loop::RunOptions options;
  options.duration_s = arguments.duration_s;
  options.real_time = arguments.real_time;
  options.passivity = device::PassivityController::mode_of(arguments.passivity);
  options.observers = std::move(observers);
  options.progress = [&progress](double fraction) { progress(fraction); };
  options.stop = &stop_flag();
  options.waiting = [](const std::string& awaited) {
    fmt::print("waiting for {}\n", awaited);
    std::fflush(stdout);
  };
  return checkpoints ? loop::run_with_checkpoints(world, options, *checkpoints, cost, from)
                     : loop::run(*world, options);
}

/// A run whose end is told in its folder, also where that end is an error: of a disk that is full, say.
/// @param ran  with all but its result
loop::RunResult run_with_summary(std::unique_ptr<loop::World>& world, const RunArguments& arguments,
                                 std::vector<loop::Observer*> observers,
                                 const loop::CheckpointPlan* checkpoints, RunOutput& ran, loop::Resumed* from,
                                 const std::string& folder) {
  try {
    return run_with_progress(world, arguments, std::move(observers), checkpoints, ran.checkpoints, from);
  } catch (const Error& e) {
    try {
      if (world) keep_summary(*world, ran, {}, arguments, folder, Outcome{"failed", e.what()});
    } catch (const Error&) {}  // on the same disk; its summary says that the run is unfinished
    fail("{} (data written so far are complete, in {})", e.what(), folder);
  }
}

int run(const RunArguments& arguments, const scene::Description& description, MissingOutputs& missing,
        Resumption* resumption) {
  const PictureOptions look = check_pictures(arguments, description);
  const bool checkpoints = arguments.checkpoint_every_s > 0.0;
  if (checkpoints) check_checkpoints(arguments, description);
  if (arguments.against_monolithic) compare::refuse_against_monolithic(description);
  const double start = wall_seconds();
  if (resumption) counters::reset();
  std::unique_ptr<loop::World> world = loop::assemble(description);
  RunOutput ran;
  ran.assemble_s = wall_seconds() - start;
  RunIdentity identity{arguments, std::filesystem::absolute(description.path).lexically_normal().string(),
                       checkpoints ? loop::fingerprint(*world) : "", store::provenance().cpu,
                       instructions_in_use()};
  if (resumption) {
    if (identity.bodies != resumption->identity.bodies)
      fail(
          "{}: a file used by the scene (a mesh, a recording) has changed since the run began; restore it, "
          "or run the scene again",
          identity.scene_path);
    resumption->from.counted = counters::snapshot();
  }
  if (checkpoints)
    if (const std::string why = loop::why_no_checkpoints(*world, {}); !why.empty())
      fail("--checkpoint-every: {}", why);

  loop::check_clock(*world, arguments.real_time);

  // A scene that records nothing writes nothing, unless something was asked for here.
  const bool keep = description.record || !arguments.folder.empty() || arguments.picture ||
                    arguments.contact_picture || arguments.frames || !arguments.movie.empty() ||
                    arguments.report || arguments.trace || checkpoints;
  const std::string folder = resumption                 ? resumption->folder
                             : arguments.folder.empty() ? default_folder(short_name(description))
                                                        : arguments.folder;
  store::ResultFolder mine;
  if (keep) {
    refuse_own_input(description, folder);
    mine = store::ResultFolder(folder);
    if (!resumption) {
      remove_run_files(description, folder);
      remove_checkpoint(folder);
    }
    keep_summary(*world, ran, {}, arguments, folder, kUnfinished);
  }

  OverlapWatch overlaps;
  std::vector<loop::Observer*> observers = {&ran.peak, &overlaps};
  Snapshot snapshot(look.shade);
  if (arguments.picture) observers.push_back(&snapshot);
  ContactSnapshot contact;
  if (arguments.contact_picture) observers.push_back(&contact);
  std::optional<Frames> frames;
  if (arguments.frames || !arguments.movie.empty())
    observers.push_back(&frames.emplace(
        *world, folder, look.shade, look.between_s,
        arguments.duration_s > 0.0 ? arguments.duration_s : description.duration_s, look.size));
  if (arguments.contact_picture || look.shade == Shade::kPenetration) world->contact->keep_views();
  std::optional<loop::Recorder> recorder;
  if (description.record) {
    if (checkpoints)
      recorder.emplace(*world, folder, resumption != nullptr, arguments.duration_s);
    else
      recorder.emplace(*world, folder);
    observers.push_back(&*recorder);
  }
  std::optional<loop::TraceRecorder> trace;
  if (arguments.trace) trace.emplace(*world, (std::filesystem::path(folder) / "trace.csv").string());
  loop::HapticMemory memory;
  if (arguments.against_monolithic) observers.push_back(&memory);
  loop::CheckpointPlan plan;
  if (checkpoints) plan = checkpoint_plan(identity, description, folder);
  const loop::CheckpointPlan* const kept = checkpoints ? &plan : nullptr;
  loop::Resumed* const from = resumption ? &resumption->from : nullptr;
  ran.result = keep ? run_with_summary(world, arguments, observers, kept, ran, from, folder)
                    : run_with_progress(world, arguments, observers, kept, ran.checkpoints, from);
  const loop::RunResult& result = ran.result;
  if (recorder) close_records(*recorder, folder, missing);
  recorder.reset();
  if (trace) {
    trace->close();
    fmt::print("trace: {} attempted steps, {} rejected; an error of 1 is the tolerance of the error test\n",
               trace->attempts(), trace->rejected());
  }

  ran.remarks = run_remarks(*world, result);
  print_outcome(*world, ran);
  if (checkpoints) print_checkpoints(ran.checkpoints, arguments.checkpoint_every_s);
  std::optional<compare::AgainstMonolithic> against;
  if (arguments.against_monolithic && result.status.ok() && !result.stopped)
    against = against_monolithic(*world, memory.records(), arguments.real_time);
  const bool against_cut = against && against->stopped;
  bool frames_cut = false;
  if (against && !against->stopped && !against->trouble.empty())
    missing.add("error against the monolithic solution", against->trouble);
  if (keep) {
    keep_summary(*world, ran, against, arguments, folder);
    if (result.status.ok() && !result.stopped) remove_checkpoint(folder);
    if (result.real_time) keep_clock(*result.real_time, folder);
    if (arguments.picture) keep_picture(*world, snapshot, folder, missing);
    if (arguments.contact_picture) contact.save(*world, folder, missing);
    if (arguments.report) missing.add(report::write_run_report(folder));
    print_files(description, folder);
    if (frames) frames_cut = keep_frames(*world, *frames, arguments, folder, result.stopped, missing);
  } else {
    fmt::print("no file was written, because the scene has no [record]\n");
  }
  if (!result.status.ok())
    fail(
        "{} failed at t = {} s: {}{}; a smaller tolerance or step often helps (--set integrator.rtol=..., "
        "integrator.step_s=...)",
        description.integrator.name, time_text(result.status.t), result.status.message,
        keep ? " (data written so far are complete)" : "");
  if (result.stopped) {
    fmt::print(stderr, "palpate: stopped at t = {} s{}\n", time_text(result.time),
               keep ? "; data written so far are complete" : "");
    if (ran.checkpoints.written > 0)
      fmt::print(stderr, "palpate: `palpate resume {}` resumes it\n", quoted(folder));
    return kExitStopped;
  }
  if (frames_cut) fmt::print(stderr, "palpate: stopped while drawing frames; those written are complete\n");
  if (against_cut)
    fmt::print(stderr,
               "palpate: stopped before the monolithic solution was complete; the run itself is complete\n");
  if (frames_cut || against_cut) return kExitStopped;
  return 0;
}

}  // namespace

int run(const RunArguments& arguments) {
  MissingOutputs missing;
  return missing.close(run(arguments, missing));
}

int run(const RunArguments& arguments, MissingOutputs& missing) {
  scene::Description description = scene_of(arguments.scene);
  // what the hand did in real time is not to be had again: it is kept, so that it can be replayed
  if (arguments.real_time && description.tool && !description.record)
    description.record = RecordSpec{.states = false};
  return run(arguments, description, missing, nullptr);
}

int resume_run(Resumption& resumption, const scene::Description& description, MissingOutputs& missing) {
  return run(resumption.identity.arguments, description, missing, &resumption);
}

}  // namespace palpate::cli
