#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::session {

/// Quantity that colours a picture.
enum class Shade { kDisplacement, kStress, kPenetration };

/// Checks at the start of a run that pictures of it can be drawn at its end.
/// @param name  "displacement", "stress" or "penetration"
/// @throws Error if pictures were not compiled in, for another name, and for penetration in a scene without
/// [[contact]]
Shade check_picture(const std::string& name, const scene::Description& description);

/// Returns whether nothing fixes the body in the world: its rigid motion is then no part of its displacement
/// in pictures.
bool is_free(const SoftBodySpec& body);

/// Returns the names of the free bodies of a scene.
std::vector<std::string> free_bodies(const scene::Description& description);

}  // namespace palpate::session
