#pragma once
#include <functional>
#include <string>
#include <vector>

#include "soup.h"

namespace palpate::model {

/// Turns the faces of each connected piece to agree, most of them as they stood, and parts the surface where
/// more than two faces meet at an edge, or pieces touch in a point.  Returns how many faces were turned.
int turn_to_agree(Soup& soup);

struct Mended {
  Soup soup;
  int holes = 0, hole_faces = 0, removed = 0;
  /// faces that went through others of their shell at first; where cutting them out failed, they still do
  int crossings = 0;
};

/// Closes holes, collapses needles and flat faces, and cuts out faces that cross.
/// @param largest_hole  share of the surface  @param place  is told where it works for long; may be empty
/// @throws Error with the place of a hole that is too large, or of a flat face that cannot be collapsed
Mended mend(const Soup& soup, double largest_hole,
            const std::function<void(const std::string& where)>& place = {});

}  // namespace palpate::model
