#pragma once
#include <string>
#include <vector>

#include "bones/shape.h"
#include "bones/tree.h"
#include "palpate/dynamics/path.h"

/// Motion of a model file's skeleton, as specified by a scene's [body.skeleton].  Each bone is attached to
/// its parent by a joint at its head, a root to the world.  A bone has a prescribed motion if it and all its
/// ancestors are welded or have keyframes: its motion is then a function of time and adds no unknowns.  All
/// other bones of a body form one tree in reduced coordinates.
namespace palpate::bones {

/// One bone of a SkeletonPlan.
struct SkeletonBone {
  TaperedBone shape;
  Pose start;           ///< pose of its frame at the start, in the world
  bool moves = true;    ///< false: at rest
  dynamics::Path path;  ///< prescribed motion; else empty
  int in_tree = -1;     ///< index in SkeletonPlan::tree; -1: prescribed motion
};

/// Bones of a skeleton, divided into prescribed and freely moving ones.
struct SkeletonPlan {
  std::vector<SkeletonBone> bones;  ///< one entry per bone of the skeleton
  std::vector<TreeBone> tree;       ///< bones that move freely
};

/// Plans the motion of a skeleton.
/// @param skeleton    in its initial configuration in the world
/// @param spec        joints and materials
/// @param body_axes   orientation of the axes in which axes and keyframes of joints are given
/// @param body, file  names for messages
/// @throws Error for a joint of an unknown bone, or joints that do not fit together
SkeletonPlan plan_skeleton(const Skeleton& skeleton, const SkeletonSpec& spec, const Quat& body_axes,
                           const std::string& body, const std::string& file);

}  // namespace palpate::bones
