#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::cli {

/// Returns the scene of a run, as session::recorded_scene(); models of the scene that are missing from the
/// cache are built.
scene::Description recorded_scene(const std::string& text, const std::filesystem::path& folder,
                                  const std::vector<std::string>& overrides = {});

}  // namespace palpate::cli
