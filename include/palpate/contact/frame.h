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
  /// Of the frame in the world at state.time.
  virtual Pose pose(const dynamics::StateView& state) const = 0;
  /// Its velocity there, world axes.
  virtual Twist twist(const dynamics::StateView& state) const = 0;
  /// False where nothing can move it: forces on it are of no consequence.
  virtual bool moves() const { return true; }
  /// True when it is a block of the State: the contact's tangent then has rows for it.
  virtual bool in_state() const { return false; }
  /// Where its six velocities stand in u, -1 when it is given from outside.
  virtual int u_offset(const dynamics::StateView&) const { return -1; }
};

/// A frame that does not move.
std::shared_ptr<MovingFrame> fixed_frame(const Pose& pose = {});

/// The free rigid body with that block id (q = qw qx qy qz px py pz, u = angular, linear).
std::shared_ptr<MovingFrame> block_frame(int block_id);

/// A frame whose motion over one exchange period is known: cubic Hermite through the poses of the ticks, of
/// the origin's position and of the rotation vector from each tick's orientation.  Poses and twists at the
/// ticks are met exactly; between them the pose is of order 4 in the tick and the twist of order 3.  Before
/// the first knot and behind the last the motion goes on with that knot's twist (an integrator may look a
/// little ahead).  Each tick rotates by less than half a turn.
class TrajectoryFrame : public MovingFrame {
 public:
  /// No knots any more.
  void clear();
  void append(double t, const Pose& pose, const Twist& twist);  ///< times increase
  /// @pre at least one knot
  Pose pose(const dynamics::StateView& state) const override;
  /// @pre at least one knot
  Twist twist(const dynamics::StateView& state) const override;

 private:
  struct Knot {
    double t;
    Pose pose;
    Twist twist;
  };
  std::vector<Knot> knots_;
};

}  // namespace palpate::contact
