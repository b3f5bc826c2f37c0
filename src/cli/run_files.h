#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

/// The files that a run may write into its folder: those of an earlier one must not pass for this one's.
namespace palpate::cli {

/// Those of a run of this scene that are there now, sorted: a file of somebody's own may be called alike that
/// of a hand that the scene does not have.
std::vector<std::string> run_files(const scene::Description& description, const std::string& folder);

/// Removes them, but for scene.toml and summary.json, which the run replaces at once.
/// @throws Error for one that cannot be removed
void remove_run_files(const scene::Description& description, const std::string& folder);

/// @throws Error where the run would write over a file that it reads: its scene, or the hand's recording
void refuse_own_input(const scene::Description& description, const std::string& folder);

}  // namespace palpate::cli
