#include "cli/scene_of.h"

#include <fmt/format.h>

#include <filesystem>

#include "cli/paths.h"
#include "model_cache.h"
#include "palpate/loop/load.h"

namespace palpate::cli {

scene::Description scene_of(const scene::SceneArguments& arguments) {
  scene::Description description = loop::load(find_scene(arguments.scene), arguments.changes());
  for (const std::string& key : description.not_carried_over)
    fmt::print(stderr,
               "palpate: {} of the scene is ignored: the selection by --integrator or --set does not use "
               "it\n",
               key);
  make_missing_models(description);
  return description;
}

std::string short_name(const scene::Description& description) {
  return std::filesystem::path(description.path).stem().string();
}

}  // namespace palpate::cli
