#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"
#include "palpate/scene/kinds.h"

namespace palpate::scene {

/// Reads and checks a TOML scene.
/// @param path  file; relative paths in it start at its folder
/// @param overrides  `body.0.youngs_modulus_pa=1e5`: a dotted path (indices count from 0) and a TOML value,
///   applied before checking.  Where they select another integrator (obstacle, method, ...) than the file
///   does, the keys that the file gives for its choice are dropped: Description::not_carried_over.
/// @param kinds  names and keys that the parts provide; `palpate::loop::load` passes those of this build
/// @throws Error `FILE:LINE:COLUMN: where: what; what to do`, with the nearest known key, for unknown keys,
///   wrong types, values out of range, keys that do not apply to the chosen part, and names that refer to
///   nothing
Description load(const std::string& path, const std::vector<std::string>& overrides, const Kinds& kinds);
/// Reads and checks a scene given as text.
/// @param text  TOML
/// @param path  for messages and relative paths; the file need not exist
/// @param overrides, kinds  as in load()
/// @throws Error as load()
Description parse(const std::string& text, const std::string& path, const std::vector<std::string>& overrides,
                  const Kinds& kinds);

/// Returns `FILE:LINE:COLUMN` of the deepest part of `at` ("body[1].mesh") that the scene's file contains,
/// for errors found after loading.  Reads the file again; where it cannot be read or parsed, returns its
/// path.
std::string place_of(const Description& description, const std::string& at);

/// Returns every key that a scene may contain, dotted: "body.mesh.radius_m".
std::vector<std::string> known_keys(const Kinds& kinds);

}  // namespace palpate::scene
