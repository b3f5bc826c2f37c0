#include "run_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/missing_outputs.h"
#include "cli/stop.h"
#include "palpate/core/error.h"

namespace palpate::cli {

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
  PictureOptions options{check_picture(arguments.shade, description)};
  if (!arguments.size.empty()) options.size = frame_size(arguments.size);
  if (movie)
    options.between_s = between_movie_frames(description, arguments.fps, arguments.slow);
  else if (arguments.frames)
    options.between_s = between_frames(description, arguments.frames_per_s);
  if (movie) check_movie(arguments.movie);
  return options;
}

RunPictures::RunPictures(loop::World& world, const RunArguments& arguments, const PictureOptions& options,
                         const std::string& folder)
    : arguments_(arguments), folder_(folder), snapshot_(options.shade) {
  if (arguments.frames || !arguments.movie.empty())
    frames_.emplace(world, folder, options.shade, options.between_s,
                    arguments.duration_s > 0.0 ? arguments.duration_s : world.description.duration_s,
                    options.size);
  if (arguments.contact_picture || options.shade == Shade::kPenetration) world.contact->keep_views();
}

std::vector<loop::Observer*> RunPictures::observers() {
  std::vector<loop::Observer*> out;
  if (arguments_.picture) out.push_back(&snapshot_);
  if (arguments_.contact_picture) out.push_back(&contact_);
  if (frames_) out.push_back(&*frames_);
  return out;
}

void RunPictures::save_pictures(const loop::World& world, MissingOutputs& missing) {
  if (arguments_.picture) {
    const std::string path = (std::filesystem::path(folder_) / "picture.png").string();
    try {
      snapshot_.save(world, path);
    } catch (const Error& e) { missing.add("picture " + path, e.what()); }
  }
  if (arguments_.contact_picture) contact_.save(world, folder_, missing);
}

bool RunPictures::save_frames(const loop::World& world, bool run_stopped, MissingOutputs& missing) {
  if (!frames_) return false;
  const std::string path = (std::filesystem::path(folder_) / "frames").string();
  const double between_s = frames_->between_s(), shown_s = between_s * arguments_.slow;
  std::unique_ptr<FrameSink> pictures, movie;
  std::vector<FrameSink*> sinks;
  if (arguments_.frames) sinks.push_back((pictures = make_frame_folder(path)).get());
  if (!arguments_.movie.empty()) sinks.push_back((movie = make_movie(arguments_.movie, shown_s)).get());
  frames_->save(world, sinks, !run_stopped, missing);
  int least = frames_->count();
  for (const FrameSink* sink : sinks) least = std::min(least, sink->written());
  if (pictures) {
    fmt::print("{} of {} frames in {}, one every {:g} s of simulated time; to make a movie in real time:\n",
               pictures->written(), frames_->count(), path, between_s);
    fmt::print("  ffmpeg -framerate {:g} -i {}/%04d.png -pix_fmt yuv420p {}.mp4\n", 1.0 / between_s, path,
               path);
  }
  if (movie)
    fmt::print("{} of {} frames in {}, one every {:g} s of simulated time; {:.4g} per second when played\n",
               movie->written(), frames_->count(), arguments_.movie, between_s, 1.0 / shown_s);
  return !run_stopped && stop_flag().load() && least < frames_->count();
}

}  // namespace palpate::cli
