#include "session/movie_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "render/animation.h"
#include "session/ffmpeg.h"

namespace palpate::session {
namespace fs = std::filesystem;
namespace {

std::string ending_of(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending;
}

std::string draft_of(const std::string& path) { return path + ".part"; }

void remove_draft(const std::string& path) {
  std::error_code none;
  fs::remove(draft_of(path), none);
}

void give_name(const std::string& path) {
  std::error_code error;
  fs::rename(draft_of(path), path, error);
  if (error) fail("{}: cannot be written: {}", path, error.message());
}

/// Movie file, created with its first picture: a run without pictures leaves no file.
class Movie : public FrameSink {
 public:
  explicit Movie(const std::string& path) : path_(path) {}
  ~Movie() override { remove_draft(path_); }
  std::string missing() const override { return "movie " + path_; }
  void close() override {
    if (written() == 0) return;
    end();
    give_name(path_);
  }

 protected:
  std::string path_;

 private:
  virtual void end() = 0;
};

class AnimatedPng final : public Movie {
 public:
  AnimatedPng(const std::string& path, double frame_s) : Movie(path), frame_s_(frame_s) {}

 private:
  void put(const render::Picture& picture) override {
    if (!writer_) writer_.emplace(draft_of(path_), frame_s_);
    writer_->add(picture);
  }
  void end() override { writer_->close(); }

  double frame_s_;
  std::optional<render::AnimationWriter> writer_;
};

using Words = std::vector<std::string>;

/// VP9 at constant quality: with -b:v 0 the size of the file follows from -crf (0 to 63, 0 is the best
/// quality).
Words webm_options() {
  return {"-c:v",      "libvpx-vp9", "-crf",    "30", "-b:v",     "0",       "-deadline", "good",
          "-cpu-used", "4",          "-row-mt", "1",  "-pix_fmt", "yuv420p", "-f",        "webm"};
}

/// H.264 at constant quality (-crf 0 to 51), with the index at the start of the file, so that a browser plays
/// it while it loads.
Words mp4_options() {
  return {"-c:v",     "libx264", "-crf",      "20",         "-preset", "medium",
          "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f",      "mp4"};
}

/// Movie that ffmpeg encodes.
class EncodedMovie final : public Movie {
 public:
  EncodedMovie(const std::string& path, double frame_s, Words options)
      : Movie(path), frame_(render::fraction_of(frame_s)), options_(std::move(options)) {}
  ~EncodedMovie() override { ffmpeg_.reset(); }  // ends ffmpeg before its draft is removed

 private:
  void put(const render::Picture& picture) override {
    if (!ffmpeg_) start(picture.width, picture.height);
    ffmpeg_->write(picture.rgba.data(), picture.rgba.size());
  }
  void end() override { ffmpeg_->finish(); }

  void start(int width, int height) {
    const std::string size = fmt::format("{}x{}", width, height),
                      rate = fmt::format("{}/{}", frame_.denominator, frame_.numerator);
    Words words = {"-loglevel", "error",      "-f", "rawvideo", "-pixel_format", "rgba", "-video_size",
                   size,        "-framerate", rate, "-i",       "pipe:0"};
    words.insert(words.end(), options_.begin(), options_.end());
    words.insert(words.end(), {"-xerror", "-y", "file:" + draft_of(path_)});
    ffmpeg_.emplace(words);
  }

  render::Fraction frame_;
  Words options_;
  std::optional<Ffmpeg> ffmpeg_;
};

}  // namespace

void check_movie(const std::string& path) {
  const std::string ending = ending_of(path);
  if (ending != ".mp4" && ending != ".webm" && ending != ".png" && ending != ".apng")
    fail(
        "--movie {}: unknown kind \"{}\"; end the name in .mp4 or .webm (by ffmpeg), .png or .apng (animated "
        "PNG)",
        path, ending);
  if (ending == ".mp4") check_ffmpeg("libx264");
  if (ending == ".webm") check_ffmpeg();
  const fs::path folder = fs::path(path).parent_path();
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (fs::is_directory(path)) fail("--movie {}: is a folder; give a file name", path);
  std::FILE* draft = error ? nullptr : std::fopen(draft_of(path).c_str(), "wb");
  if (!draft)
    fail("--movie {}: cannot be written ({})", path, error ? error.message() : std::strerror(errno));
  std::fclose(draft);
  remove_draft(path);
}

std::unique_ptr<FrameSink> make_movie(const std::string& path, double frame_s) {
  if (ending_of(path) == ".mp4") return std::make_unique<EncodedMovie>(path, frame_s, mp4_options());
  if (ending_of(path) == ".webm") return std::make_unique<EncodedMovie>(path, frame_s, webm_options());
  return std::make_unique<AnimatedPng>(path, frame_s);
}

}  // namespace palpate::session
