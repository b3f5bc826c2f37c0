#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::scene {

/// Reads and checks a TOML scene.  Unknown keys, wrong types, values out of range and names that refer to
/// nothing are refused:
/// `FILE:LINE:COLUMN: where: what; what to do`, with the nearest known key.
/// @param overrides  `body.0.youngs_modulus_pa=1e5`: a dotted path (indices count from 0) and a TOML value,
///   applied before checking
Description load(const std::string& path, const std::vector<std::string>& overrides = {});
Description parse(const std::string& text, const std::string& path,
                  const std::vector<std::string>& overrides = {});

/// Every key that a scene may contain, dotted: "body.mesh.radius_m".
std::vector<std::string> known_keys();

}  // namespace palpate::scene
