#pragma once
#include <vector>

#include "soup.h"

namespace palpate::model {

/// Returns the faces that intersect others, ascending; empty: none.
/// @pre faces are oriented consistently, and every edge has one or two of them
std::vector<int> crossing_faces(const Soup& soup);

}  // namespace palpate::model
