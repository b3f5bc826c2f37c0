#include "session/recorded_scene.h"

#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "store/summary.h"

namespace palpate::session {
namespace {

/// Returns the original path of the scene of a run; for an interrupted run, which has no summary, the path of
/// its scene.toml.
std::string path_of_scene(const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder / "summary.json")) {
    store::Summary summary = store::read_summary((folder / "summary.json").string());
    for (const auto& [name, value] : summary.section("options").values)
      if (const auto* path = std::get_if<std::string>(&value); path && name == "scene_path") return *path;
  }
  return (folder / "scene.toml").string();
}

}  // namespace

scene::Description recorded_scene(const std::string& text, const std::filesystem::path& folder,
                                  const std::vector<std::string>& overrides) {
  const std::string path = path_of_scene(folder);
  try {
    return loop::parse(text, path, overrides);
  } catch (const Error& e) {
    // line numbers refer to the text that the run kept; the original scene file may have changed since
    if (std::string_view(e.what()).starts_with(path))
      fail("{}{}", (folder / "scene.toml").string(), e.what() + path.size());
    throw;
  }
}

}  // namespace palpate::session
