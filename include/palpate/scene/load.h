#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"
#include "palpate/scene/kinds.h"

namespace palpate::scene {

/// Reads and checks a TOML scene.  Unknown keys, wrong types, values out of range, keys that mean nothing to
/// what the scene names, and names that refer to nothing are refused:
/// `FILE:LINE:COLUMN: where: what; what to do`, with the nearest known key.
/// @param overrides  `body.0.youngs_modulus_pa=1e5`: a dotted path (indices count from 0) and a TOML value,
///   applied before checking.  Where they name another integrator (obstacle, method, ...) than the file does,
/// @param path  of the file; relative paths in it start at its folder
///   what the file says for its own is not carried over: Description::not_carried_over.
/// @param kinds  what the parts say of names and their keys.  `palpate::loop::load` has those of this build.
Description load(const std::string& path, const std::vector<std::string>& overrides, const Kinds& kinds);
/// As load(), from a text.  @param text  TOML  @param path  for messages and relative paths; there need be no
/// such file
/// @param overrides, kinds  as of load()
Description parse(const std::string& text, const std::string& path, const std::vector<std::string>& overrides,
                  const Kinds& kinds);

/// `FILE:LINE:COLUMN` of the deepest part of `at` ("body[1].mesh") that the scene's file has, for what is
/// found wrong after loading.  Reads the file again; where that is not to be had, its path alone.
std::string place_of(const Description& description, const std::string& at);

/// Every key that a scene may contain, dotted: "body.mesh.radius_m".
std::vector<std::string> known_keys(const Kinds& kinds);

}  // namespace palpate::scene
