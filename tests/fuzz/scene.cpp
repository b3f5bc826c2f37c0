#include <algorithm>

#include "fuzz/input.h"
#include "fuzz/scene_kinds.h"
#include "fuzz/targets.h"
#include "palpate/scene/load.h"

namespace palpate::fuzz {

/// Reads a scene. The first line may be an override, `--set PATH=VALUE`; the rest is the scene.
void scene(std::string_view bytes) {
  constexpr std::string_view kSet = "--set ";
  std::vector<std::string> overrides;
  if (bytes.starts_with(kSet)) {
    const std::string_view line = bytes.substr(0, bytes.find('\n'));
    overrides.emplace_back(line.substr(kSet.size()));
    bytes.remove_prefix(std::min(line.size() + 1, bytes.size()));
  }
  is_read([&] { scene::parse(std::string(bytes), "fuzz.toml", overrides, scene_kinds()); });
}

}  // namespace palpate::fuzz
