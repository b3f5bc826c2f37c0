#pragma once

namespace palpate::contact {

/// Options of a contact in image space.
struct ImageOptions {
  int pixels = 64;             ///< Longer edge of the image [pixels].
  double candidate_gap = 0.0;  ///< Candidate gap [m]; 0: a quarter of the soft surface's mean edge.
  /// Time to the next query [s]: the candidate gap of a region is at least the distance by which its surfaces
  /// may approach each other in this time at their present velocities.
  double look_ahead = 0.0;
  /// Shift of the pixel grid, in pixels, in [0, 1): for studies of the discretisation error.
  double shift_u = 0.0;
  double shift_v = 0.0;
};

}  // namespace palpate::contact
