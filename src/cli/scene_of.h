#pragma once
#include <string>

#include "palpate/scene/description.h"
#include "session/options.h"

namespace palpate::cli {

using session::SceneArguments;

/// Finds, modifies and checks the scene of the command line.
scene::Description scene_of(const SceneArguments& arguments);

/// Returns the file name of the scene without its ending, which names its results: "press-ball".
std::string short_name(const scene::Description& description);

}  // namespace palpate::cli
