#pragma once
#include <vector>

#include "palpate/bones/spec.h"
#include "palpate/core/pose.h"
#include "palpate/dynamics/path.h"

/// Bones whose motion is known beforehand.
namespace palpate::bones {

/// A fixed bone stays where it is placed; keyframes move it from there: X(t) = (R(t) R0, p0 + p(t)).
dynamics::Path placed_path(const BoneSpec& spec);

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
dynamics::Path prescribed_path(const PrescribedJoint& joint, dynamics::Path parent, const Pose& parent_start);

}  // namespace palpate::bones
