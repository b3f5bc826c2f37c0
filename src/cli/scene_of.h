#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::cli {

/// Which scene, and what is changed in it.
struct SceneArguments {
  std::string scene;                   ///< path or name
  std::vector<std::string> overrides;  ///< "body.0.youngs_modulus_pa=1e5"
  std::string integrator;              ///< instead of the scene's own; empty: the scene's
};

/// Finds, changes and checks the scene that the command line names.
scene::Description scene_of(const SceneArguments& arguments);

/// "press-ball": the file's name without its ending, which names its results.
std::string short_name(const scene::Description& description);

}  // namespace palpate::cli
