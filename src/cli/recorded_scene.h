#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::cli {

/// The scene of a run, from its text as the run kept it; models that it names are made where they are not
/// kept any more.
/// @param folder     of the run: relative paths start where the scene's file was, else there
/// @param overrides  KEY=VALUE
scene::Description recorded_scene(const std::string& text, const std::filesystem::path& folder,
                                  const std::vector<std::string>& overrides = {});

}  // namespace palpate::cli
