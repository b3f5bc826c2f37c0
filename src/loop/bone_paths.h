#pragma once
#include "palpate/device/handle.h"
#include "palpate/fem/attachments.h"

namespace palpate::loop {

/// A bone that moves by a script against its parent, which has a prescribed motion as well, or stands still.
struct ToldJoint {
  Pose start;                           ///< of the bone's own frame, in the world
  Vec3 position = Vec3::Zero();         ///< of the joint at the start [m]
  Quat axes = Quat::Identity();         ///< keyframes are in these: the body's own
  std::vector<KeyframeSpec> keyframes;  ///< empty: goes with its parent
};

/// The bone's path.  @param parent  its parent's path and place at the start; an empty path: the world
fem::Path told_path(const ToldJoint& joint, fem::Path parent, const Pose& parent_start);

}  // namespace palpate::loop
