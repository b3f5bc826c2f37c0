#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::cli {

/// Scene argument of a command and the changes to the scene.
struct SceneArguments {
  std::string scene;                   ///< Path or name
  std::vector<std::string> overrides;  ///< Changes of keys: "body.0.youngs_modulus_pa=1e5"
  std::string integrator;              ///< Integrator that replaces the one of the scene; empty: unchanged
};

/// Finds, modifies and checks the scene of the command line.
scene::Description scene_of(const SceneArguments& arguments);

/// Returns the file name of the scene without its ending, which names its results: "press-ball".
std::string short_name(const scene::Description& description);

}  // namespace palpate::cli
