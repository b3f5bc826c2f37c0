#pragma once
#include <vector>

#include "palpate/bones/spec.h"
#include "palpate/core/pose.h"
#include "palpate/dynamics/path.h"

/// Prescribed motions of bones.
namespace palpate::bones {

/// Returns the path of a fixed bone, which stays at its initial pose, or of a bone with keyframes:
/// X(t) = (R(t) R0, p0 + p(t)).
dynamics::Path placed_path(const BoneSpec& spec);

/// Bone with keyframes relative to its parent, which has a prescribed motion too, or is at rest.
struct PrescribedJoint {
  Pose start;                           ///< pose of the bone's frame at the start, in the world
  Vec3 position = Vec3::Zero();         ///< position of the joint at the start [m]
  Quat axes = Quat::Identity();         ///< orientation of the body axes, in which the keyframes are given
  std::vector<KeyframeSpec> keyframes;  ///< empty: the bone moves with its parent
};

/// Returns the bone's path.
/// @param parent        its parent's path; an empty path: the world
/// @param parent_start  the parent's pose at the start
dynamics::Path prescribed_path(const PrescribedJoint& joint, dynamics::Path parent, const Pose& parent_start);

}  // namespace palpate::bones
