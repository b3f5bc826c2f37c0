#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/types.h"

namespace palpate::scene {

/// Returns the names of view directions: front, back, left, right, top, bottom.
const std::vector<std::string>& view_names();

/// Returns the direction from the scene to the eye.
/// @param text  a name of view_names(), or "x,y,z".  The eye is at -y for front, at +y for back, at -x for
/// left, at +x for right, at +z for top, at -z for bottom
/// @return empty for another text, and for a direction that is zero or not finite
std::optional<Vec3> view_direction(const std::string& text);

}  // namespace palpate::scene
