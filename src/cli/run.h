#pragma once
#include <string>

#include "cli/scene_of.h"

namespace palpate::cli {

class MissingOutputs;

/// Arguments of `palpate run`.
struct RunArguments {
  SceneArguments scene;
  std::string folder;       ///< empty: out/NAME
  double duration_s = 0.0;  ///< 0: the scene's
  bool picture = false, report = false, trace = false, real_time = false;
  bool contact_picture = false, frames = false;
  double frames_per_s = 0.0;           ///< of simulated time; 0: as the scene records
  std::string movie;                   ///< file; empty: none
  double fps = 0.0, slow = 1.0;        ///< of the movie as it is played; 0: 25, or what the loop allows
  std::string size;                    ///< of frames and movie, "640x480"; empty: the default
  std::string shade = "displacement";  ///< of picture, frames and movie; or "stress", "penetration"
  std::string passivity = "off";       ///< or "observe", "control"
  bool against_monolithic = false;     ///< repeat it as one system, and print the distance
  double checkpoint_every_s = 0.0;     ///< simulated time between checkpoints; 0: none
};

/// Runs a scene and keeps what it records.  @return the exit status  @throws Error for invalid input
int run(const RunArguments& arguments);

/// Runs as a part of another command, which reports and closes `missing`.
int run(const RunArguments& arguments, MissingOutputs& missing);

}  // namespace palpate::cli
