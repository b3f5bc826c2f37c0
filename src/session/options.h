#pragma once
#include <string>

#include "scene/scene_arguments.h"

namespace palpate::session {

/// Options of a run. Messages about them name the options of `palpate run`, which have the same names.
struct Options {
  scene::SceneArguments scene;  ///< Kept in summary.json and in checkpoints
  std::string folder;           ///< Output folder; empty: out/NAME, and only if there is a file to write
  /// Simulated time [s]; 0: the duration of the scene; infinity: until the run is stopped
  double duration_s = 0.0;
  std::string command;  ///< Command line for the summary; empty: made of these options
  bool picture = false, report = false, trace = false, real_time = false;
  bool contact_picture = false, frames = false;
  double frames_per_s = 0.0;           ///< Frames per second of simulated time; 0: as the scene records
  std::string movie;                   ///< Movie file; empty: none
  double fps = 0.0, slow = 1.0;        ///< Playback of the movie; fps = 0: 25, or as the loop allows
  std::string size;                    ///< Size of frames and movie, "640x480"; empty: default size
  std::string shade = "displacement";  ///< Colours of pictures; or "stress", "penetration"
  std::string passivity = "off";       ///< Or "observe", "control"
  bool against_monolithic = false;     ///< Compares with the monolithic solution
  double checkpoint_every_s = 0.0;     ///< Simulated time between checkpoints [s]; 0: none

  bool draws_frames() const { return frames || !movie.empty(); }
};

}  // namespace palpate::session
