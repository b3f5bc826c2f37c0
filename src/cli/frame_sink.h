#pragma once
#include <memory>
#include <string>

#include "render/picture.h"

namespace palpate::cli {

/// Where pictures of a run go, one behind the other and of one size; none is kept.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// @throws Error where it cannot be written
  void add(const render::Picture& picture) {
    put(picture);
    ++written_;
  }
  /// Behind the last.  @throws Error where it cannot be written
  virtual void close() = 0;
  /// What there is not where one of these has failed.
  virtual std::string missing() const = 0;
  int written() const { return written_; }

 private:
  virtual void put(const render::Picture& picture) = 0;
  int written_ = 0;
};

/// 0000.png, 0001.png, ... in a folder, each whole or not at all; what lay there of an earlier run is
/// removed.
std::unique_ptr<FrameSink> make_frame_folder(const std::string& folder);

/// Refuses at the start of a run what could not be written at its end, and makes the file's folder.
/// @param path  ending in .webm (VP9, by the program ffmpeg), .png or .apng (an animated PNG, by palpate)
/// @throws Error for another ending, for a folder that cannot be written, where ffmpeg is not installed
void check_movie(const std::string& path);

/// A movie: written under its name with ".part" behind it; it gets its name when it is whole, and is removed
/// where it never is.
/// @param frame_s  how long a picture is shown [s]
/// @pre check_movie(path)
std::unique_ptr<FrameSink> make_movie(const std::string& path, double frame_s);

}  // namespace palpate::cli
