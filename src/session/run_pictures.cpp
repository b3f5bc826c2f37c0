#include "session/run_pictures.h"

#include <algorithm>
#include <filesystem>
#include <memory>

#include "palpate/core/error.h"
#include "session/frame_folder.h"
#include "session/movie_file.h"

namespace palpate::session {

PictureOptions check_pictures(const Options& options, const scene::Description& description) {
  if (options.contact_picture && description.contacts.empty())
    fail("--contact-picture: the scene has no [[contact]]");
  const bool movie = !options.movie.empty();
  if (options.frames_per_s > 0.0 && !options.frames) fail("--frames-per-s needs --frames");
  if (options.frames_per_s > 0.0 && movie)
    fail("--frames-per-s: with --movie the frames are those of the movie; use --fps and --slow instead");
  if ((options.fps > 0.0 || options.slow != 1.0) && !movie) fail("--fps and --slow need --movie");
  if (!options.size.empty() && !options.draws_frames()) fail("--size needs --frames or --movie");
  if (!options.picture && !options.contact_picture && !options.draws_frames()) return {};
  PictureOptions out{check_picture(options.shade, description)};
  if (!options.size.empty()) out.size = frame_size(options.size);
  if (movie)
    out.between_s = between_movie_frames(description, options.fps, options.slow);
  else if (options.frames)
    out.between_s = between_frames(description, options.frames_per_s);
  if (movie) check_movie(options.movie);
  return out;
}

RunPictures::RunPictures(loop::World& world, const Options& options, const PictureOptions& pictures,
                         const std::string& folder)
    : options_(options), folder_(folder), largest_(pictures.shade), picture_(pictures.shade) {
  if (options.draws_frames())
    frames_.emplace(world, folder, pictures.shade, pictures.between_s,
                    options.duration_s > 0.0 ? options.duration_s : world.description.duration_s,
                    pictures.size);
  if (options.contact_picture || pictures.shade == Shade::kPenetration) world.contact->keep_views();
}

std::vector<loop::Observer*> RunPictures::observers() {
  std::vector<loop::Observer*> out;
  if (options_.picture || frames_) out.push_back(&largest_);
  if (options_.picture) out.push_back(&picture_);
  if (options_.contact_picture) out.push_back(&contact_picture_);
  if (frames_) out.push_back(&*frames_);
  return out;
}

std::optional<double> RunPictures::largest_value() const {
  if (!options_.picture && !frames_) return {};
  return largest_.value();
}

void RunPictures::save_pictures(const loop::World& world, MissingOutputs& missing) {
  if (options_.picture) {
    const std::string path = (std::filesystem::path(folder_) / "picture.png").string();
    try {
      picture_.save(world, path, largest_.value());
    } catch (const Error& e) { missing.add("picture " + path, e.what()); }
  }
  if (options_.contact_picture) contact_picture_.save(world, folder_, missing);
}

std::optional<DrawnFrames> RunPictures::draw_frames(const loop::World& world, const Callbacks& callbacks,
                                                    MissingOutputs& missing) {
  if (!frames_) return {};
  DrawnFrames out;
  out.count = frames_->count();
  out.between_s = frames_->between_s();
  out.shown_s = out.between_s * options_.slow;
  std::unique_ptr<FrameSink> pictures, movie;
  std::vector<FrameSink*> sinks;
  if (options_.frames) {
    out.folder = (std::filesystem::path(folder_) / "frames").string();
    sinks.push_back((pictures = make_frame_folder(out.folder)).get());
  }
  if (!options_.movie.empty()) {
    out.movie = options_.movie;
    sinks.push_back((movie = make_movie(out.movie, out.shown_s)).get());
  }
  frames_->save(world, sinks, callbacks, missing, largest_.value());
  if (pictures) out.in_folder = pictures->written();
  if (movie) out.in_movie = movie->written();
  int least = out.count;
  for (const FrameSink* sink : sinks) least = std::min(least, sink->written());
  out.stopped = callbacks.stopped() && least < out.count;
  return out;
}

}  // namespace palpate::session
