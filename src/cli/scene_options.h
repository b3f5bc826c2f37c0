#pragma once
#include "cli/scene_of.h"

namespace CLI {
class App;
}

/// Options of commands that read a scene.
namespace palpate::cli {

/// Adds SCENE, --set, --beyond-memory and, where `integrator` is set, --integrator.
void add_scene(CLI::App& command, scene::SceneArguments& scene, bool integrator);

/// Adds --beyond-memory, which accepts scenes that are likely to need more memory than there is.
void add_beyond_memory(CLI::App& command);

}  // namespace palpate::cli
