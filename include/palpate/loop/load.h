#pragma once
#include <string>
#include <vector>

#include "palpate/scene/load.h"

namespace palpate::loop {

/// What the registries of this build know of the names in a scene.
const scene::Kinds& kinds();

/// scene::load and scene::parse with kinds(): what a program calls.
scene::Description load(const std::string& path, const std::vector<std::string>& overrides = {});
/// As load(), from a text.  @param text  TOML  @param path  for messages and relative paths; there need be no
/// such file
/// @param overrides  as of scene::load()
scene::Description parse(const std::string& text, const std::string& path,
                         const std::vector<std::string>& overrides = {});

}  // namespace palpate::loop
