#include "session/recorded_movie.h"

#include <algorithm>
#include <filesystem>
#include <memory>

#include "core/rigid_fit.h"
#include "loop/haptic_record.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "palpate/store/run_file.h"
#include "session/movie_file.h"
#include "session/movie_frames.h"
#include "session/shade_values.h"
#include "store/summary.h"

namespace palpate::session {
namespace {

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

  WorldSnapshot at(int step, Shade shade) const {
    const Points points = reader_.points(step);
    const VecX stress = shade == Shade::kStress ? reader_.stress(step) : VecX();
    WorldSnapshot out;
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

/// Returns the largest value that pictures of the run show; 0 if it had none of this shade.
double largest_value_of(const std::filesystem::path& folder, const std::string& shade) {
  const std::filesystem::path file = folder / "summary.json";
  if (!std::filesystem::exists(file)) return 0.0;
  store::Summary summary = store::read_summary(file.string());
  std::string of;
  double largest = 0.0;
  for (const auto& [name, value] : summary.section("pictures").values) {
    if (const auto* text = std::get_if<std::string>(&value); text && name == "shade") of = *text;
    if (const auto* number = std::get_if<double>(&value); number && name == "largest_value")
      largest = *number;
  }
  return of == shade ? largest : 0.0;
}

/// Adds each state after the ticks up to its time, so that the handle has the pose of the hand at that time.
/// @return the largest value of all states, between the frames, too
double show(MovieFrames& frames, const loop::World& world, const States& states, int steps, Shade shade,
            const std::vector<loop::TickRecord>& ticks, const Callbacks& callbacks) {
  double largest = 0.0;
  auto tick = ticks.begin();
  for (int step = 0; step < steps && !callbacks.stopped(); ++step) {
    WorldSnapshot snapshot = states.at(step, shade);
    for (; tick != ticks.end() && tick->time <= snapshot.time + 1e-9; ++tick) frames.tick(*tick);
    largest = std::max(largest, largest_value(world, snapshot, shade));
    frames.show(std::move(snapshot));
  }
  for (; tick != ticks.end(); ++tick) frames.tick(*tick);
  return largest;
}

/// Returns the ticks of the first hand; none if they were not recorded.
std::vector<loop::TickRecord> ticks_of(const scene::Description& description,
                                       const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "haptic.h5";
  // the folder may hold an older haptic.h5 of another scene
  if (!description.tool || !description.record || !description.record->forces ||
      !std::filesystem::exists(file))
    return {};
  return loop::read_haptic_record(file.string()).ticks;
}

}  // namespace

DrawnFrames draw_recorded_movie(const MovieOptions& options, const SceneReader& read_scene,
                                const Callbacks& callbacks, MissingOutputs& missing) {
  const std::filesystem::path folder(options.run);
  const std::string states_file = (folder / "run.vtkhdf").string();
  if (!std::filesystem::exists(states_file))
    fail("{}: no such file; a run writes it if the scene sets record.states = true", states_file);
  if (options.shade == "penetration")
    fail(
        "--shade penetration: runs do not record penetration; use `palpate run SCENE --movie --shade "
        "penetration`");
  const store::RunReader reader(states_file);
  const scene::Description description = read_scene(reader.info().scene_source, folder);
  const Shade shade = check_picture(options.shade, description);
  const FrameSize size = options.size.empty() ? FrameSize{} : frame_size(options.size);
  DrawnFrames out;
  out.between_s = between(reader.times_s(), options.fps, options.slow, options.run);
  out.shown_s = out.between_s * options.slow;
  out.movie = options.file.empty() ? (folder / "movie.png").string() : options.file;
  check_movie(out.movie);
  const auto world = loop::assemble(description);
  const States states(states_file, *world, reader);
  MovieFrames frames(*world, folder.string(), shade, out.between_s, reader.times_s().back(), size);
  const double of_states =
      show(frames, *world, states, reader.steps(), shade, ticks_of(description, folder), callbacks);
  const double of_run = largest_value_of(folder, options.shade);
  const std::unique_ptr<FrameSink> sink = make_movie(out.movie, out.shown_s);
  frames.save(*world, {sink.get()}, callbacks, missing, of_run > 0.0 ? of_run : of_states);
  out.count = frames.count();
  out.in_movie = sink->written();
  out.stopped = callbacks.stopped();
  return out;
}

}  // namespace palpate::session
