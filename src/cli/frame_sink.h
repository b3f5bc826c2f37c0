#pragma once
#include <memory>
#include <string>

#include "render/picture.h"

namespace palpate::cli {

/// Receiver of the pictures of a run in order, all of one size. It keeps no picture in memory.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// Adds a picture.  @throws Error if it cannot be written
  void add(const render::Picture& picture) {
    put(picture);
    ++written_;
  }
  /// Completes the output after the last picture.  @throws Error if it cannot be written
  virtual void close() = 0;
  /// Returns the name of the output that is missing if add() or close() failed.
  virtual std::string missing() const = 0;
  /// Returns the number of pictures added so far.
  int written() const { return written_; }

 private:
  virtual void put(const render::Picture& picture) = 0;
  int written_ = 0;
};

/// Returns a sink that writes 0000.png, 0001.png, ... into a folder, each atomically; pictures of an earlier
/// run are removed.
std::unique_ptr<FrameSink> make_frame_folder(const std::string& folder);

/// Rejects at the start of a run a movie that could not be written at its end, and creates the folder of the
/// file.
/// @param path  file name ending in .webm (VP9, by the program ffmpeg), .png or .apng (an animated PNG, by
/// palpate)
/// @throws Error for another ending, for a folder that cannot be written, or if ffmpeg is required and not
/// installed
void check_movie(const std::string& path);

/// Returns a sink that writes a movie. The file is written with ".part" appended to its name, renamed when it
/// is complete, and removed if it never is.
/// @param frame_s  display time of a picture [s]
/// @pre check_movie(path)
std::unique_ptr<FrameSink> make_movie(const std::string& path, double frame_s);

}  // namespace palpate::cli
