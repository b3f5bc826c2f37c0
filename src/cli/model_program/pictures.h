#pragma once
#include <string>

#include "mesh/layered_model.h"

namespace palpate::cli {

/// Rejects at the start a picture that could not be drawn at the end.  @throws Error with the reason
void check_pictures(const std::string& path);

/// Draws four views into one PNG: the skin; the tetrahedra cut open, shaded by their smallest dihedral angle;
/// the skin over its tetrahedra; the convex proxies with the bones, if any.
void draw_model(const LayeredModel& model, const std::string& path);

}  // namespace palpate::cli
