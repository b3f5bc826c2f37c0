#pragma once
#include <string>
#include <vector>

#include "palpate/core/types.h"

namespace palpate {

/// A bone at rest: the capsule with a radius at each end (a cone between two balls), in the axes of the
/// model.
struct Bone {
  std::string name;                             ///< unique in the skeleton
  int parent = -1;                              ///< index of a bone before this one; -1: a root
  Vec3 head = Vec3::Zero();                     ///< where it hangs on its parent: the joint [m]
  Vec3 tail = Vec3::Zero();                     ///< its other end [m]
  double head_radius = 0.0, tail_radius = 0.0;  ///< [m], positive
};

/// Bones in an order in which parents stand before their children; empty: none.
struct Skeleton {
  std::vector<Bone> bones;  ///< parents before their children
};

}  // namespace palpate
