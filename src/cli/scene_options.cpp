#include "scene_options.h"

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "cli/option_checks.h"

namespace palpate::cli {

// An environment variable, so that processes that this one starts have it, too (core/memory.h reads it).
void add_beyond_memory(CLI::App& command) {
  command.add_flag_callback(
      "--beyond-memory", [] { ::setenv("PALPATE_BEYOND_MEMORY", "1", 1); },
      "go on where the scene is likely to need more memory than there is");
}

void add_scene(CLI::App& command, SceneArguments& scene, bool integrator) {
  command.add_option("SCENE", scene.scene, kSceneHelp)->required();
  command
      .add_option("--set", scene.overrides,
                  "change one value of the scene: KEY=VALUE, the key dotted, tables counted from 0, the "
                  "value as in TOML")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  if (integrator)
    command
        .add_option("--integrator", scene.integrator,
                    "instead of the scene's: see `palpate list integrators`")
        ->type_name("NAME");
  add_beyond_memory(command);
}

}  // namespace palpate::cli
