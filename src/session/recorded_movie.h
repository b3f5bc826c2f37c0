#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "palpate/scene/description.h"
#include "session/callbacks.h"
#include "session/run_output.h"

namespace palpate::session {

/// Options of a movie of a finished run.
struct MovieOptions {
  std::string run;                          ///< Folder of a run
  std::string file;                         ///< Movie file; empty: movie.png in that folder
  double fps = 0.0, slow = 1.0;             ///< Playback; fps = 0: 25, or the rate of the recorded states
  std::string size;                         ///< "640x480"; empty: default size
  std::string shade = "displacement";       ///< Or "stress"
  std::vector<std::string> overrides = {};  ///< Changes of the scene's [view], KEY=VALUE
};

/// Function that returns the scene of a run from the text that the run kept and from its folder, as
/// recorded_scene(); it may also build models of the scene.
using SceneReader =
    std::function<scene::Description(const std::string& text, const std::filesystem::path& folder)>;

/// Draws a movie of a finished run from its recorded states. Nothing is computed again.
/// @param missing  receives the movie if it cannot be written
/// @throws Error if the run recorded no states, for options that do not suit them, and if the scene or its
/// meshes have changed
DrawnFrames draw_recorded_movie(const MovieOptions& options, const SceneReader& read_scene,
                                const Callbacks& callbacks, MissingOutputs& missing);

}  // namespace palpate::session
