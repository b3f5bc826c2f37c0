#pragma once
#include <array>

#include "palpate/mesh/mesh.h"

namespace palpate::mesh {

/// Returns the signed volume [m^3], det[b-a, c-a, d-a] / 6: positive when d sees (a, b, c) counter-clockwise.
double tet_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// Returns the signed volume of one tetrahedron of a mesh [m^3].
double tet_volume(const TetMesh& mesh, int tet);

/// Returns the six angles between faces, inside a tetrahedron of positive volume [rad]; entry e belongs to
/// edge kTetEdges[e].
std::array<double, 6> dihedral_angles(const TetMesh& mesh, int tet);

/// Node pairs of a tetrahedron's edges.
inline constexpr int kTetEdges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
/// Faces of a positive tetrahedron, outwards; face f lies opposite node f.
inline constexpr int kTetFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/// Report of a mesh check.
struct MeshReport {
  int nodes = 0, elements = 0;                     ///< counts of the checked mesh
  int flipped = 0;                                 ///< elements whose orientation was corrected
  double volume = 0.0;                             ///< [m^3]
  double smallest_dihedral_deg = 180.0;            ///< between two faces of one tetrahedron
  double largest_edge = 0.0, smallest_edge = 0.0;  ///< [m]
};

/// Measures counts, volume, smallest dihedral angle and edge lengths.
MeshReport measure(const TetMesh& mesh);

}  // namespace palpate::mesh
