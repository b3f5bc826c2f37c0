#pragma once
#include "fit_volume.h"

namespace palpate::model {

struct ManifoldReport {
  int taken = 0;              ///< tetrahedra
  double volume = 0.0;        ///< theirs [m^3]
  Vec3 place = Vec3::Zero();  ///< of the first of them [m]
};

/// Makes the boundary a surface that nowhere touches itself: each of its edges has two faces, and the faces
/// at each vertex are one fan.  Where several fans of tetrahedra meet at an edge or a node only, all but the
/// largest are taken away, and at last what hangs together with the largest piece by no face.  A mesh whose
/// boundary is sound stays as it is, to the last bit.
ManifoldReport make_boundary_manifold(FittedMesh& mesh);

}  // namespace palpate::model
