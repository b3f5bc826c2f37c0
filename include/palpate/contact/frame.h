#pragma once
#include <memory>
#include <vector>

#include "palpate/core/pose.h"
#include "palpate/dynamics/state.h"

namespace palpate::contact {

/// Rigid frame that carries one side of a contact: fixed, prescribed in time, or a block of the State.
class MovingFrame {
 public:
  virtual ~MovingFrame() = default;
  /// Returns the pose of the frame in the world at state.time.
  virtual Pose pose(const dynamics::StateView& state) const = 0;
  /// Returns the twist of the frame at state.time, world axes [rad/s, m/s].
  virtual Twist twist(const dynamics::StateView& state) const = 0;
  /// Returns false where the frame cannot move, so that forces on it have no effect.
  virtual bool moves() const { return true; }
  /// Returns true for a block of the State: the contact's tangent then has rows for the frame.
  virtual bool in_state() const { return false; }
  /// Returns the offset of its six velocities in u; -1 for a prescribed frame.
  virtual int u_offset(const dynamics::StateView&) const { return -1; }
};

/// Returns a frame that does not move.
std::shared_ptr<MovingFrame> fixed_frame(const Pose& pose = {});

/// Returns the frame of the free rigid body with that block id (q = qw qx qy qz px py pz, u = angular,
/// linear).
std::shared_ptr<MovingFrame> block_frame(int block_id);

/// Frame with a known motion over one exchange period: cubic Hermite interpolation between the poses at the
/// ticks, applied to the origin's position and to the rotation vector relative to each tick's orientation.
/// Poses and twists at the ticks are reproduced exactly; between them the pose is of order 4 in the tick
/// length and the twist of order 3. Before the first knot and after the last the motion is extrapolated with
/// that knot's twist, since an integrator may look slightly ahead.
/// @pre each tick rotates by less than half a turn
class TrajectoryFrame : public MovingFrame {
 public:
  /// Motion at one time.
  struct Knot {
    double t = 0.0;  ///< Time [s].
    Pose pose;       ///< Pose of the frame.
    Twist twist;     ///< Twist of its origin.
  };
  /// Removes all knots.
  void clear();
  /// Removes all knots but the last.
  void restart();
  /// Returns the last knot. @pre at least one knot
  const Knot& last() const;
  /// Adds a knot at time t [s]; times must increase.
  void append(double t, const Pose& pose, const Twist& twist);
  /// Returns the interpolated pose at state.time. @pre at least one knot
  Pose pose(const dynamics::StateView& state) const override;
  /// Returns the interpolated twist at state.time. @pre at least one knot
  Twist twist(const dynamics::StateView& state) const override;

 private:
  std::vector<Knot> knots_;
};

}  // namespace palpate::contact
