#pragma once
#include <string>
#include <vector>

#include "cli/scene_of.h"

namespace CLI {
class App;
}

/// Options of commands that read a scene.
namespace palpate::cli {

/// Adds SCENE, --set, --beyond-memory and, where `integrator` is set, --integrator.
void add_scene(CLI::App& command, scene::SceneArguments& scene, bool integrator);

/// Adds --view and --zoom, which change the [view] of the scene by overrides.
/// @param overrides  receives them; must outlive the command
void add_view(CLI::App& command, std::vector<std::string>& overrides);
/// Adds --view and --zoom, which keep their values: an accepted direction (scene/view.h), and a factor.
void add_view(CLI::App& command, std::string& direction, double& zoom);

/// Adds --beyond-memory, which accepts scenes that are likely to need more memory than there is.
void add_beyond_memory(CLI::App& command);

}  // namespace palpate::cli
