#pragma once
#include <string>

#include "mesh/layered_model.h"

namespace palpate::cli {

/// Refuses at the start what could not be drawn at the end.
void check_pictures(const std::string& path);

/// One PNG of four views: the skin, the tetrahedra cut open and shaded by their smallest dihedral angle, the
/// skin over its tetrahedra, and the convex proxies with the bones where there are any.
void draw_model(const LayeredModel& model, const std::string& path);

}  // namespace palpate::cli
