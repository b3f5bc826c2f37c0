#pragma once
#include <string>

#include "palpate/scene/description.h"
#include "scene/scene_arguments.h"

namespace palpate::cli {

/// Scene argument of a command and the changes to the scene; a type of this namespace, so that a call of
/// scene_of() with it finds the function below also where a file has a function of that name.
struct SceneArguments : scene::SceneArguments {};

/// Finds, modifies and checks the scene of the command line.
scene::Description scene_of(const scene::SceneArguments& arguments);

/// Returns the file name of the scene without its ending, which names its results: "press-ball".
std::string short_name(const scene::Description& description);

}  // namespace palpate::cli
