#pragma once
#include <random>

#include "palpate/core/pose.h"

namespace palpate::bench {

/// Where a body meets its partner, and how far it may go from there.
struct Meeting {
  Pose start;           ///< of the body against where the scene puts it
  Vec3 pivot;           ///< the middle of what touches first [m]
  Vec3 away;            ///< unit: the way back, off the partner
  double reach = 0.0;   ///< unit of length of a path: the distance between the two middles [m]
  bool inside = false;  ///< the scene starts with the bodies in one another (gears): no way back
};

/// A smooth path around a meeting: each coordinate is a sine of its own phase, one or two periods long.
/// Along `away` it goes 0.03 reach into the partner and 0.01 out of it, so that contact opens and closes;
/// across it 0.06 reach; it rotates by 0.1 rad about the pivot.  Interlocked bodies go 0.01 reach, 0.02 rad.
class RelativePath {
 public:
  RelativePath(const Meeting& meeting, std::mt19937& random);
  Pose at(double s) const;  ///< s from 0 to 1

 private:
  Meeting meeting_;
  Mat3 axes_;  // columns: away, and two across it
  Vec6 mean_ = Vec6::Zero(), amplitude_, phase_, turns_;
};

/// Uniform in a cube of half edge `most` [rad].
Vec3 random_rotation(std::mt19937& random, double most);

}  // namespace palpate::bench
