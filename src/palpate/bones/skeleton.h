#pragma once
#include <string>
#include <vector>

#include "palpate/bones/shape.h"
#include "palpate/bones/tree.h"
#include "palpate/dynamics/path.h"

/// The skeleton of a model file, as a scene's [body.skeleton] moves it.  Each bone hangs on its parent by a
/// joint at its head, a root on the world.  A bone has a prescribed motion where everything from it up to the
/// world is welded or has keyframes: then it is a function of time, and costs no unknown.  All others of a
/// body are one tree in reduced coordinates.
namespace palpate::bones {

struct SkeletonBone {
  TaperedBone shape;
  Pose start;           ///< of its own frame, in the world
  bool moves = true;    ///< false: stays where it is
  dynamics::Path path;  ///< of a prescribed motion; else empty
  int in_tree = -1;     ///< which bone of the tree; -1: its motion is prescribed
};

struct SkeletonPlan {
  std::vector<SkeletonBone> bones;  ///< one each of the skeleton's
  std::vector<TreeBone> tree;       ///< those that move freely
};

/// @param skeleton  as it stands in the world at the start  @param body_axes  axes and keyframes of joints
/// are
///   in these  @param body, file  names for messages
/// @throws Error for a joint of a bone that is not there, or joints that do not fit together
SkeletonPlan plan_skeleton(const Skeleton& skeleton, const SkeletonSpec& spec, const Quat& body_axes,
                           const std::string& body, const std::string& file);

}  // namespace palpate::bones
