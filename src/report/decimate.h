#pragma once
#include <vector>

#include "palpate/core/types.h"

namespace palpate::report {

/// Subset of the vertices of a surface, and faces between them.
struct CoarseSurface {
  std::vector<int> kept;  ///< Indices of vertices of the surface
  Faces faces;            ///< Indices into `kept`
};

/// Returns a surface with at most `most` vertices, for a picture. All vertices in one cell of a grid are
/// merged to the vertex nearest to their mean (vertex clustering; Rossignac and Borrel 1993). A surface that
/// is small enough is unchanged.
/// @pre most >= 8
CoarseSurface decimate(const Points& vertices, const Faces& faces, int most);

}  // namespace palpate::report
