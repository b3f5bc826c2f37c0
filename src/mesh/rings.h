#pragma once
#include <vector>

namespace palpate::mesh {

/// One ring (of a disc) or shell (of a ball): its sectors' edges are cut into `frequency` parts.  The last
/// one is the centre, {0, 0}.
struct Ring {
  int frequency;
  double radius;
};

/// Rings from the outermost inwards.  From one to the next the frequency falls by one, so that elements keep
/// their size, or to its half, so that they double; thicknesses follow, and a smooth stretch makes up the
/// rest of `grading` (thickness in the middle / at the surface).
std::vector<Ring> rings(double radius, int frequency, double grading);

}  // namespace palpate::mesh
