#pragma once
#include "palpate/core/pose.h"

namespace palpate::contact {

/// Contact wrench on one frame and its derivatives, about the frame's origin, angular before linear.
struct FrameLinearisation {
  Wrench wrench;  ///< Wrench on the frame [N m, N].
  Mat6 K, B;      ///< -dF/dx and -dF/dv of the frame, bodies held fixed.
  /// Part of -K that is due to the rotation of the lever arms under the present forces (rotational rows and
  /// columns).
  Mat3 geometric;
  MatX K_body, B_body;    ///< nodal_size x 6: -df_nodes/dx_frame, -df_nodes/dv_frame.
  MatX K_frame, B_frame;  ///< 6 x nodal_size: -dF_frame/dx_nodes, -dF_frame/dv_nodes.
  int active = 0;         ///< Number of samples with pressure.
};

/// Selects samples of a frame by the other side: nodes, another frame, or both.
enum class Partners { kAll, kNodes, kFrames };

}  // namespace palpate::contact
