#pragma once
#include <array>
#include <string>
#include <vector>

#include "mesh/provenance.h"
#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// Unconnected triangles, each with its place in the source file; -1 for elements that repair added.
struct Soup {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> faces;
  std::vector<int> vertex_source, face_source;
  const mesh::Provenance* from = nullptr;

  TriMesh surface() const;
  double diagonal() const;               ///< diagonal of the bounding box [m]
  std::string vertex_name(int v) const;  ///< e.g. `liver.obj:12: vertex 11 at (1, 2, 3) m`
  std::string face_name(int f) const;    ///< with the coordinates of its centroid
};
/// Builds a soup; `from` must outlive it.
/// @throws Error for numbers that are not finite, no faces, indices out of range
Soup soup_of(const TriMesh& faces, const mesh::Provenance& from);

/// Merges vertices within `tolerance` [m] of each other along every axis into the first of them (0: exactly
/// equal vertices).  Returns how many were merged.
int weld(Soup& soup, double tolerance);
int drop_collapsed(Soup& soup);  ///< drops faces with a repeated vertex; returns their number
/// Drops faces with the same three vertices, in any orientation, except the first; returns their number.
int drop_duplicates(Soup& soup);
int drop_unused(Soup& soup);  ///< drops vertices of no face; returns their number

}  // namespace palpate::model
