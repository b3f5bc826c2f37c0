#pragma once
#include "palpate/device/handle.h"
#include "palpate/fem/attachments.h"

namespace palpate::loop {

/// A bone with keyframes relative to its parent, which has a prescribed motion as well, or stands still.
struct PrescribedJoint {
  Pose start;                           ///< of the bone's own frame, in the world
  Vec3 position = Vec3::Zero();         ///< of the joint at the start [m]
  Quat axes = Quat::Identity();         ///< keyframes are in these: the body's own
  std::vector<KeyframeSpec> keyframes;  ///< empty: goes with its parent
};

/// The bone's path.
/// @param parent  its parent's path; an empty path: the world
/// @param parent_start  the parent's pose at the start
fem::Path prescribed_path(const PrescribedJoint& joint, fem::Path parent, const Pose& parent_start);

}  // namespace palpate::loop
