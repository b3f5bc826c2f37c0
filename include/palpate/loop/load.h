#pragma once
#include <string>
#include <vector>

#include "palpate/scene/load.h"

namespace palpate::loop {

/// Returns the valid names in scenes and their keys, from the registries of this build.
const scene::Kinds& kinds();

/// Loads a scene file: scene::load() with kinds(), for use by programs.
/// @param path  scene file  @param overrides  as in scene::load()
scene::Description load(const std::string& path, const std::vector<std::string>& overrides = {});
/// Parses a scene from a text, as load() does from a file.
/// @param text  TOML  @param path  for messages and relative paths; the file need not exist
/// @param overrides  as in scene::load()
scene::Description parse(const std::string& text, const std::string& path,
                         const std::vector<std::string>& overrides = {});

/// Replaces each mesh file "model:NAME" of a description by the path of the model in the cache, as load()
/// does.
scene::Description with_cached_models(scene::Description description);

}  // namespace palpate::loop
