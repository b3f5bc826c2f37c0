#pragma once
#include <array>
#include <string>
#include <vector>

#include "palpate/mesh/checks.h"
#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// Triangles on their way to a surface, which remember where in the file each stood: -1 for what repair
/// added.
struct Soup {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> faces;
  std::vector<int> vertex_source, face_source;
  const mesh::Provenance* from = nullptr;

  TriMesh surface() const;
  double diagonal() const;               ///< of the bounding box [m]
  std::string vertex_name(int v) const;  ///< `liver.obj:12: vertex 11 at (1, 2, 3) m`
  std::string face_name(int f) const;    ///< with the coordinates of its middle
};
/// @throws Error for numbers that are not finite, no faces, indices out of range
Soup soup_of(const TriMesh& faces, const mesh::Provenance& from);

/// Vertices within `tolerance` [m] of each other along every axis become the first of them (0: exactly equal
/// ones).  Returns how many went.
int weld(Soup& soup, double tolerance);
int drop_collapsed(Soup& soup);  ///< faces with a vertex twice
/// of faces with the same three vertices, all but the first, whichever way they turn
int drop_duplicates(Soup& soup);
int drop_unused(Soup& soup);  ///< vertices of no face

}  // namespace palpate::model
