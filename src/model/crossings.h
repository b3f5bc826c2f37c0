#pragma once
#include <vector>

#include "soup.h"

namespace palpate::model {

/// Faces that go through others, rising; empty: none.
/// @pre faces agree in their turning, and every edge has one or two of them
std::vector<int> crossing_faces(const Soup& soup);

}  // namespace palpate::model
