#include "scene/scene_arguments.h"

namespace palpate::scene {

std::vector<std::string> SceneArguments::changes() const {
  std::vector<std::string> out = overrides;
  if (!integrator.empty()) out.push_back("integrator.name=\"" + integrator + "\"");
  return out;
}

}  // namespace palpate::scene
