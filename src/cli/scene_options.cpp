#include "scene_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "cli/option_checks.h"
#include "palpate/core/error.h"
#include "scene/view.h"

namespace palpate::cli {
namespace {

/// Accepts a view direction.
const CLI::Validator is_view(
    [](const std::string& text) {
      if (scene::view_direction(text)) return std::string();
      std::string names;
      for (const std::string& name : scene::view_names()) names += name + ", ";
      return fmt::format("{} is no view: use {}or X,Y,Z{}", text, names,
                         suggestion(text, scene::view_names()));
    },
    "", "");

void describe_view(CLI::Option* option) {
  option
      ->description(
          "side of the eye in pictures: front (-y), back, left (-x), right, top, bottom, or X,Y,Z; default: "
          "the scene's [view], or one that shows the tool")
      ->type_name("DIR")
      ->check(is_view);
}

void describe_zoom(CLI::Option* option) {
  option->description("magnification of pictures; 1 shows the whole scene")
      ->type_name("FACTOR")
      ->check(positive);
}

}  // namespace

// An environment variable, so that processes that this one starts have it, too (core/memory.h reads it).
void add_beyond_memory(CLI::App& command) {
  command.add_flag_callback(
      "--beyond-memory", [] { ::setenv("PALPATE_BEYOND_MEMORY", "1", 1); },
      "continue even if the scene probably needs more memory than is available");
}

void add_view(CLI::App& command, std::vector<std::string>& overrides) {
  const auto direction = [&overrides](const std::string& text) {
    overrides.push_back("view.direction=\"" + text + "\"");
  };
  const auto zoom = [&overrides](double factor) { overrides.push_back(fmt::format("view.zoom={}", factor)); };
  describe_view(command.add_option_function<std::string>("--view", direction));
  describe_zoom(command.add_option_function<double>("--zoom", zoom));
}

void add_view(CLI::App& command, std::string& direction, double& zoom) {
  describe_view(command.add_option("--view", direction));
  describe_zoom(command.add_option("--zoom", zoom));
}

void add_scene(CLI::App& command, scene::SceneArguments& scene, bool integrator) {
  command.add_option("SCENE", scene.scene, kSceneHelp)->required();
  command
      .add_option(
          "--set", scene.overrides,
          "change one value of the scene: KEY=VALUE with a dotted key, table indices from 0, and a TOML "
          "value; a text needs no quotes")
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
