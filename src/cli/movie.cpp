// Pictures of a finished run, from its recorded states.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "cli/missing_outputs.h"
#include "cli/program.h"
#include "cli/stop.h"
#include "commands.h"
#include "core/rigid_fit.h"
#include "frames.h"
#include "loop/haptic_record.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "palpate/store/run_file.h"
#include "recorded_scene.h"

namespace palpate::cli {
namespace {

struct MovieArguments {
  std::string run;                     ///< Folder of a run
  std::string file;                    ///< Movie file; empty: movie.png in that folder
  double fps = 0.0, slow = 1.0;        ///< Playback; fps = 0: 25, or the rate of the recorded states
  std::string size;                    ///< "640x480"; empty: default size
  std::string shade = "displacement";  ///< Or "stress"
};

/// Recorded states of a run, with its parts in the order of the recorder: bodies, bones with a shape, tools.
class States {
 public:
  States(const std::string& path, const loop::World& world, const store::RunReader& reader)
      : world_(world), reader_(reader) {
    const std::vector<scene::Hand> hands = scene::hands_of(world.description);
    std::size_t expected = world.bodies.size() + hands.size();
    for (const loop::Bone& bone : world.bones) expected += bone.surface.vertices.cols() > 0;
    if (reader.parts().size() != expected)
      fail("{}: has {} parts, but its scene has {}; the run was made by another version of palpate", path,
           reader.parts().size(), expected);
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      if (reader.parts()[i].reference.cols() != world.bodies[i].placed.cols())
        fail("{}: body \"{}\" has {} nodes, but its scene now has {}: the mesh has changed since the run",
             path, world.bodies[i].name, reader.parts()[i].reference.cols(), world.bodies[i].placed.cols());
    for (const scene::Hand& hand : hands) tools_.push_back(loop::tool_surface(*hand.tool, world.folder));
  }

  Instant at(int step, Shade shade) const {
    const Points points = reader_.points(step);
    const VecX stress = shade == Shade::kStress ? reader_.stress(step) : VecX();
    Instant out;
    out.time = reader_.times_s()[static_cast<std::size_t>(step)];
    int part = 0;
    for (const loop::Body& body : world_.bodies) {
      const int first = reader_.first_point(part++);
      const Eigen::Index n = body.placed.cols();
      // the file stores the nodes in the order of the mesh file
      out.nodes.emplace_back(points.middleCols(first, n)(Eigen::all, body.file_node));
      if (stress.size() > 0) out.stress.emplace_back(stress.segment(first, n)(body.file_node));
    }
    const auto pose = [&](const TriMesh& surface) {
      const int first = reader_.first_point(part++);
      return rigid_fit(surface.vertices, points.middleCols(first, surface.vertices.cols()));
    };
    for (const loop::Bone& bone : world_.bones)
      out.bones.push_back(bone.surface.vertices.cols() > 0 ? pose(bone.surface) : Pose{});
    for (const TriMesh& tool : tools_) out.tools.push_back(pose(tool));
    return out;
  }

 private:
  const loop::World& world_;
  const store::RunReader& reader_;
  std::vector<TriMesh> tools_;
};

/// Returns the time between two frames [s], a multiple of the interval of recorded states.
double between(const std::vector<double>& times, double fps, double slow, const std::string& run) {
  if (times.size() < 2)
    fail("{}: the run recorded {} state{}; a movie requires at least two", run, times.size(),
         times.size() == 1 ? "" : "s");
  const double state = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  const double rate = fps > 0.0 ? fps : std::min(kMovieRate, 1.0 / (state * slow));
  const double requested = 1.0 / (rate * slow);
  if (requested < 0.999 * state)
    fail(
        "--fps {:g} --slow {:g}: the frame rate exceeds that of the recorded states, one per {:g} s "
        "(record.state_period_s) or {:g} per second of playback; reduce the frame rate",
        rate, slow, state, 1.0 / (state * slow));
  return static_cast<double>(std::max(1L, std::lround(requested / state))) * state;
}

/// Adds each state after the ticks up to its time, so that the handle has the pose of the hand at that time.
void show(Frames& frames, const States& states, int steps, Shade shade,
          const std::vector<loop::TickRecord>& ticks) {
  auto tick = ticks.begin();
  for (int step = 0; step < steps && !stop_flag().load(); ++step) {
    Instant instant = states.at(step, shade);
    for (; tick != ticks.end() && tick->time <= instant.time + 1e-9; ++tick) frames.tick(*tick);
    frames.show(std::move(instant));
  }
  for (; tick != ticks.end(); ++tick) frames.tick(*tick);
}

int movie(const MovieArguments& arguments, MissingOutputs& missing) {
  const std::filesystem::path folder(arguments.run);
  const std::string states_file = (folder / "run.vtkhdf").string();
  if (!std::filesystem::exists(states_file))
    fail("{}: no such file; a run writes it if the scene sets record.states = true", states_file);
  if (arguments.shade == "penetration")
    fail(
        "--shade penetration: runs do not record penetration; use `palpate run SCENE --movie --shade "
        "penetration`");
  const store::RunReader reader(states_file);
  const scene::Description description = recorded_scene(reader.info().scene_source, folder);
  const Shade shade = check_picture(arguments.shade, description);
  const FrameSize size = arguments.size.empty() ? FrameSize{} : frame_size(arguments.size);
  const double between_s = between(reader.times_s(), arguments.fps, arguments.slow, arguments.run);
  const std::string path = arguments.file.empty() ? (folder / "movie.png").string() : arguments.file;
  check_movie(path);
  const auto world = loop::assemble(description);
  const States states(states_file, *world, reader);
  std::vector<loop::TickRecord> ticks;
  // the folder may hold an older haptic.h5 of another scene
  if (description.tool && description.record && description.record->forces &&
      std::filesystem::exists(folder / "haptic.h5"))
    ticks = loop::read_haptic_record((folder / "haptic.h5").string()).ticks;
  Frames frames(*world, folder.string(), shade, between_s, reader.times_s().back(), size);
  show(frames, states, reader.steps(), shade, ticks);
  const double shown_s = between_s * arguments.slow;
  const std::unique_ptr<FrameSink> sink = make_movie(path, shown_s);
  frames.save(*world, {sink.get()}, true, missing);
  fmt::print("{} of {} frames in {}, one every {:g} s of simulated time; {:.4g} per second when played\n",
             sink->written(), frames.count(), path, between_s, 1.0 / shown_s);
  if (!stop_flag().load()) return 0;
  fmt::print(stderr, "palpate: stopped while drawing frames; those written are complete\n");
  return kExitStopped;
}

int movie(const MovieArguments& arguments) {
  MissingOutputs missing;
  return missing.close(movie(arguments, missing));
}

}  // namespace

void add_movie(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("movie", "make a movie of a completed run");
  auto arguments = std::make_shared<MovieArguments>();
  command->add_option("run", arguments->run, "folder of a run, which contains run.vtkhdf")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("-o,--output", arguments->file, "the movie (.webm, .png or .apng); default DIR/movie.png")
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
  command->footer(R"(Examples:
  palpate movie out/press-ball
  palpate movie out/press-ball --slow 4 --shade stress -o touch.webm

Shows the recorded states (record.state_period_s), also of an interrupted run, with the force on the hand
below.  Nothing is computed again.)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return movie(*arguments); }; });
}

}  // namespace palpate::cli
