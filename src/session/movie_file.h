#pragma once
#include <memory>
#include <string>

#include "session/frame_sink.h"

namespace palpate::session {

/// Rejects at the start of a run a movie that could not be written at its end, and creates the folder of the
/// file.
/// @param path  file name ending in .mp4 (H.264, by the program ffmpeg), .webm (VP9, by ffmpeg), .png or
/// .apng (an animated PNG, by palpate)
/// @throws Error for another ending, for a folder that cannot be written, or if ffmpeg is required and not
/// installed or lacks the encoder
void check_movie(const std::string& path);

/// Returns a sink that writes a movie. The file is written with ".part" appended to its name, renamed when it
/// is complete, and removed if it never is.
/// @param frame_s  display time of a picture [s]
/// @pre check_movie(path)
std::unique_ptr<FrameSink> make_movie(const std::string& path, double frame_s);

}  // namespace palpate::session
