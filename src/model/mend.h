#pragma once
#include <functional>
#include <string>
#include <vector>

#include "soup.h"

namespace palpate::model {

/// Orients the faces of each connected piece consistently, keeping the orientation of the majority, and
/// separates the surface where more than two faces meet at an edge, or pieces touch in a point.  Returns the
/// number of faces that were turned.
int orient_consistently(Soup& soup);

/// Result of `mend`.
struct Mended {
  Soup soup;
  int holes = 0, hole_faces = 0, removed = 0;
  /// Faces that initially intersected others of their shell; if cutting them out failed, they still do.
  int crossings = 0;
};

/// Closes holes, collapses needles and flat faces, and cuts out faces that intersect.
/// @param largest_hole  largest share of the surface's area that closing may add
/// @param place         receives the place of a long operation; may be empty
/// @throws Error with the place of a hole that is too large, or of a flat face that cannot be collapsed
Mended mend(const Soup& soup, double largest_hole,
            const std::function<void(const std::string& where)>& place = {});

}  // namespace palpate::model
