#include "session/options.h"

namespace palpate::session {

std::vector<std::string> SceneArguments::changes() const {
  std::vector<std::string> out = overrides;
  if (!integrator.empty()) out.push_back("integrator.name=\"" + integrator + "\"");
  return out;
}

}  // namespace palpate::session
