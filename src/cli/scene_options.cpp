#include "scene_options.h"

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "cli/option_checks.h"

namespace palpate::cli {

// An environment variable, so that processes that this one starts have it, too (core/memory.h reads it).
void add_beyond_memory(CLI::App& command) {
  command.add_flag_callback(
      "--beyond-memory", [] { ::setenv("PALPATE_BEYOND_MEMORY", "1", 1); },
      "continue even if the scene probably needs more memory than is available");
}

void add_scene(CLI::App& command, scene::SceneArguments& scene, bool integrator) {
  command.add_option("SCENE", scene.scene, kSceneHelp)->required();
  command
      .add_option(
          "--set", scene.overrides,
          "change one value of the scene: KEY=VALUE with a dotted key, table indices from 0, and a TOML "
          "value")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  if (integrator)
    command
        .add_option("--integrator", scene.integrator,
                    "replace the scene's integrator: see `palpate list integrators`")
        ->type_name("NAME");
  add_beyond_memory(command);
}

}  // namespace palpate::cli
