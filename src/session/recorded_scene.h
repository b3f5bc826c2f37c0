#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::session {

/// Returns the scene of a run, parsed from the text that the run kept.
/// @param text       text of the scene
/// @param folder     folder of the run: relative paths start at the folder of the original scene file, or
/// else here
/// @param overrides  KEY=VALUE
scene::Description recorded_scene(const std::string& text, const std::filesystem::path& folder,
                                  const std::vector<std::string>& overrides = {});

}  // namespace palpate::session
