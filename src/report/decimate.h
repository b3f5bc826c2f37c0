#pragma once
#include <vector>

#include "palpate/core/types.h"

namespace palpate::report {

/// Some of a surface's vertices, and faces between them.
struct CoarseSurface {
  std::vector<int> kept;  ///< indices of the surface's vertices
  Faces faces;            ///< into `kept`
};

/// A surface with at most `most` vertices, for a picture: all vertices in one cell of a grid become the one
/// that is nearest to their mean (vertex clustering; Rossignac and Borrel 1993).  A surface that is small
/// enough stays as it is.
/// @pre most >= 8
CoarseSurface decimate(const Points& vertices, const Faces& faces, int most);

}  // namespace palpate::report
