#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

/// Files that a run may write into its folder. Files of an earlier run must not pass for files of this run.
namespace palpate::session {

/// Returns the sorted names of the existing files in the folder that a run of this scene may write. Per-hand
/// files count only for hands of the scene, since a file of the user may have the name that a further hand
/// would give.
std::vector<std::string> run_files(const scene::Description& description, const std::string& folder);

/// Removes these files except scene.toml and summary.json, which the run replaces at once.
/// @throws Error for a file that cannot be removed
void remove_run_files(const scene::Description& description, const std::string& folder);

/// Checks that a run does not overwrite its inputs.
/// @throws Error if the run would overwrite a file that it reads: its scene, or the recording of a hand
void refuse_own_input(const scene::Description& description, const std::string& folder);

}  // namespace palpate::session
