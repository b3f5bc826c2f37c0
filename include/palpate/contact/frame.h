#pragma once
#include <memory>
#include <vector>

#include "palpate/core/pose.h"
#include "palpate/dynamics/state.h"

namespace palpate::contact {

/// A rigid frame that carries one side of a contact: fixed, moving with time, or a block of the State.
class MovingFrame {
 public:
  virtual ~MovingFrame() = default;
  virtual Pose pose(const dynamics::StateView& state) const = 0;
  virtual Twist twist(const dynamics::StateView& state) const = 0;
  /// Where its six velocities stand in u, -1 when it is given from outside.
  virtual int u_offset(const dynamics::StateView&) const { return -1; }
};

/// A frame that does not move.
std::shared_ptr<MovingFrame> fixed_frame(const Pose& pose = {});

/// The free rigid body with that block id (q = qw qx qy qz px py pz, u = angular, linear).
std::shared_ptr<MovingFrame> block_frame(int block_id);

/// A frame whose motion over one exchange period is known: cubic Hermite through the poses of the ticks.
class TrajectoryFrame : public MovingFrame {
 public:
  void clear();
  void append(double t, const Pose& pose, const Twist& twist);  ///< times increase
  Pose pose(const dynamics::StateView& state) const override;
  Twist twist(const dynamics::StateView& state) const override;

 private:
  struct Knot { double t; Pose pose; Twist twist; };
  std::vector<Knot> knots_;
};

}  // namespace palpate::contact
