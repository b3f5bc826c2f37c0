#include "scene_of.h"

#include <fmt/format.h>

#include <filesystem>

#include "palpate/scene/load.h"
#include "places.h"

namespace palpate::cli {

scene::Description scene_of(const SceneArguments& arguments) {
  std::vector<std::string> overrides = arguments.overrides;
  if (!arguments.integrator.empty())
    overrides.push_back(fmt::format("integrator.name=\"{}\"", arguments.integrator));
  return scene::load(find_scene(arguments.scene), overrides);
}

std::string short_name(const scene::Description& description) {
  return std::filesystem::path(description.path).stem().string();
}

}  // namespace palpate::cli
