#pragma once
#include <vector>

namespace palpate::mesh {

/// Ring of a disc, or shell of a ball: its sectors' edges are cut into `frequency` parts.  The last ring is
/// the centre, {0, 0}.
struct Ring {
  int frequency;
  double radius;
};

/// Returns rings from the outermost inwards.  From ring to ring the frequency falls by one, which keeps the
/// element size, or to one half, which doubles it; the thicknesses follow, and a smooth stretch provides the
/// rest of `grading` (thickness in the middle / at the surface).
std::vector<Ring> rings(double radius, int frequency, double grading);

}  // namespace palpate::mesh
