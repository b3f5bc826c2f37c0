#pragma once
#include "commands.h"
#include "palpate/scene/description.h"

namespace palpate::cli {

/// Finds, changes and checks the scene that the command line names.
scene::Description scene_of(const SceneArguments& arguments);

/// "press-ball": the file's name without its ending, which names its results.
std::string short_name(const scene::Description& description);

}  // namespace palpate::cli
