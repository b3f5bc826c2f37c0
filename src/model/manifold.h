#pragma once
#include "fit_volume.h"

namespace palpate::model {

/// Tetrahedra removed by make_boundary_manifold.
struct ManifoldReport {
  int taken = 0;              ///< number of tetrahedra
  double volume = 0.0;        ///< their volume [m^3]
  Vec3 place = Vec3::Zero();  ///< centroid of the first of them [m]
};

/// Makes the boundary a 2-manifold: each of its edges has two faces, and the faces at each vertex form one
/// fan.  If several fans of tetrahedra meet only at an edge or a node, all but the largest are removed; if a
/// single fan touches itself there, its smallest tetrahedron on the boundary is removed.  Finally all pieces
/// that share no face with the largest piece are removed.  A mesh with a sound boundary is left bitwise
/// unchanged.
ManifoldReport make_boundary_manifold(FittedMesh& mesh);

}  // namespace palpate::model
