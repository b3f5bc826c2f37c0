#pragma once
#include <functional>
#include <string>
#include <vector>

#include "palpate/scene/description.h"
#include "session/checkpoint_files.h"
#include "store/checkpoint_file.h"

namespace palpate::session {

/// Run to resume from its checkpoint.
struct Resumption {
  std::string folder;
  RunIdentity identity;
  store::Checkpoint checkpoint;
  loop::Resumed from;  ///< State of the loop, decoded from `checkpoint`
};

/// Returns whether the run in a folder has finished, and nothing is left to resume.
/// @throws Error if there is no such folder
bool is_finished_run(const std::string& folder);

/// Reads the checkpoint of a run.
/// @throws Error if there is none, or if another version of palpate wrote it
Resumption read_resumption(const std::string& folder);

/// Reads the scene of a run again, by `load` from its file, or from the checkpoint if it was made from a
/// text.
/// @param load  function that loads and checks a scene, given by the absolute path of its file
/// @throws Error if the file no longer exists, or if the scene has changed since the run began
scene::Description scene_to_resume(
    const Resumption& resumption,
    const std::function<scene::Description(const scene::SceneArguments&)>& load);

/// Returns the differences between the processor on which the run began and this one, which change the
/// rounding of the rest of the run: one line per difference.
std::vector<std::string> processor_differences(const Resumption& resumption);

}  // namespace palpate::session
