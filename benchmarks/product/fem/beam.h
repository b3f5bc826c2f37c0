#pragma once
#include "palpate/dynamics/system.h"
#include "palpate/fem/soft_body.h"
#include "product/fem.h"

namespace palpate::bench {

TetMesh beam_mesh(int along, int across);

/// Beam in motion. E = 1e5: it falls under its weight, hanging from its held end. Stiffer ones would only
/// vibrate slightly: their held end rotates, at 3 rad/s after a start of 0.1 s, and bends them.
struct Beam {
  dynamics::State state;
  dynamics::System system;
  VecX rest, masses;
  int tetrahedra = 0;
  Beam(int along, int across, double youngs_modulus_pa);
  /// Returns the angle between the line through the free end's axis now and at rest.
  double end_rotation() const;
  double body_bytes() const;

 private:
  std::shared_ptr<fem::SoftBody> body_;
};

}  // namespace palpate::bench
