#pragma once
#include <random>

#include "palpate/core/pose.h"

namespace palpate::bench {

/// Position in which a body meets its partner, and the range of its motion from there.
struct Meeting {
  Pose start;           ///< Pose of the body relative to its pose in the scene.
  Vec3 pivot;           ///< Centre of the first contact [m].
  Vec3 away;            ///< Unit vector of the way back, off the partner.
  double reach = 0.0;   ///< Unit of length of a path: distance of the two centres [m].
  bool inside = false;  ///< The bodies interlock at the start of the scene (gears): no way back.
};

/// Smooth path around a meeting: each coordinate is a sine with a random phase, one or two periods long.
/// Along `away` it extends 0.03 reach into the partner and 0.01 out of it, so that contact opens and closes;
/// across it 0.06 reach; it rotates by 0.1 rad about the pivot. Interlocked bodies move by 0.01 reach, 0.02
/// rad.
class RelativePath {
 public:
  RelativePath(const Meeting& meeting, std::mt19937& random);
  Pose at(double s) const;  ///< s from 0 to 1.

 private:
  Meeting meeting_;
  Mat3 axes_;  // Columns: away, and two across it.
  Vec6 mean_ = Vec6::Zero(), amplitude_, phase_, turns_;
};

/// Returns a rotation vector that is uniform in a cube with the half edge `most` [rad].
Vec3 random_rotation(std::mt19937& random, double most);

}  // namespace palpate::bench
