#pragma once
#include "mesh/provenance.h"
#include "palpate/mesh/quality.h"

namespace palpate::mesh {

/// A triangle is degenerate if 2 |A| / (longest edge)^2 is at most this bound.
inline constexpr double kDegenerateTriangle = 1e-9;

/// Checks the boundary surface of a body: closed (each edge in exactly two faces), consistently oriented
/// (corrected by walking from face to face), outwards (inwards around a cavity), without degenerate or
/// duplicate faces or unreferenced vertices.  Leaves MeshReport.smallest_dihedral_deg at its default.
/// @throws Error with the place of the first defect
MeshReport check_surface(TriMesh& mesh, const Provenance& from);

}  // namespace palpate::mesh
