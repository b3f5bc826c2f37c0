#pragma once
#include <string>
#include <vector>

#include "palpate/core/types.h"

namespace palpate {

/// Bone at rest: a capsule with a radius at each end (a cone between two balls), in model coordinates.
struct Bone {
  std::string name;                             ///< unique in the skeleton
  int parent = -1;                              ///< index of a bone before this one; -1: a root
  Vec3 head = Vec3::Zero();                     ///< end at the parent: the joint [m]
  Vec3 tail = Vec3::Zero();                     ///< other end [m]
  double head_radius = 0.0, tail_radius = 0.0;  ///< [m], positive
};

/// Bones in an order in which parents precede their children; empty: none.
struct Skeleton {
  std::vector<Bone> bones;  ///< parents precede their children
};

}  // namespace palpate
