#pragma once
#include "palpate/core/types.h"

namespace palpate::contact {

/// Connection of a node to a frame: a spring of zero length and a damper tie the node to a point of the
/// frame.
struct Tie {
  int node = 0;                           ///< Node, counted over all node blocks.
  Vec3 anchor = Vec3::Zero();             ///< Attachment point in the frame's axes [m].
  double stiffness = 0.0, damping = 0.0;  ///< Spring and damper constants [N/m, N s/m].
};

}  // namespace palpate::contact
