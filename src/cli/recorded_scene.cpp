#include "recorded_scene.h"

#include "model_cache.h"
#include "session/recorded_scene.h"

namespace palpate::cli {

scene::Description recorded_scene(const std::string& text, const std::filesystem::path& folder,
                                  const std::vector<std::string>& overrides) {
  scene::Description description = session::recorded_scene(text, folder, overrides);
  make_missing_models(description);
  return description;
}

}  // namespace palpate::cli
