#pragma once
#include "palpate/core/pose.h"

namespace palpate::tool {

/// Motion of the handle over one tick: pose and twist at the start, and at the end (for implicit schemes).
struct HandleMotion {
  Pose pose0, pose1;     ///< At the start and at the end of the tick.
  Twist twist0, twist1;  ///< At the start and at the end of the tick.
};

/// Equation of one linearly implicit Euler step of a tool, A du = r, with du the change of the twist, angular
/// part first [rad/s, m/s].
struct StepEquation {
  Mat6 A = Mat6::Zero();  ///< M + h B + h^2 K, including gyroscopic terms.
  Vec6 r = Vec6::Zero();  ///< Right-hand side [N m s, N s].
};

}  // namespace palpate::tool
