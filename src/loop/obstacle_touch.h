#pragma once
#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/exchange.h"
#include "palpate/dynamics/rigid_body.h"

namespace palpate::loop {

/// Contact of a tool of ticks with obstacles.  No body answers it, so that it needs no exchange: it is linear
/// about the tool as it is at each tick.  It knows no World, and belongs to the ticks' thread.
class ObstacleTouch {
 public:
  /// @param look_ahead_s  for how long a query finds what may touch: the next is due then
  explicit ObstacleTouch(double look_ahead_s);

  /// What pairs are made with: the contact that takes them, the tool's frame in it and its motion.
  contact::ContactForce& contact() { return contact_; }
  int frame() const { return frame_; }
  const std::shared_ptr<contact::TrajectoryFrame>& motion() const { return motion_; }

  /// The record of the bodies, going on about the tool as it is, and the obstacles' contact there.
  /// @param t     at a tick's start [s]; queries follow from it and from those before, so that the same ticks
  ///              make the same ones; one that finds more than any before takes memory
  /// @param tool  then
  dynamics::LinearisedContact with(const dynamics::LinearisedContact& record, double t,
                                   const dynamics::RigidMotion& tool);
  /// Whether something with friction touches in the tick under way.
  bool rubs() const { return rubs_; }
  /// Takes the tool's end of the tick, as the last record leads to it, for the next guess of friction.
  /// False: the record's friction is not the law's at that end, and with() gives a better one.
  bool improve(const dynamics::RigidMotion& end);
  /// The tick is over: the next call of with() begins another.
  void end_tick();
  /// Between two ticks.  The next one queries, whether one is due or not.
  void archive(Archive& a, double t, const dynamics::RigidMotion& tool);

 private:
  void place(double t, const dynamics::RigidMotion& tool);

  double look_ahead_, due_ = -HUGE_VAL;
  contact::ContactForce contact_;
  std::shared_ptr<contact::TrajectoryFrame> motion_;
  int frame_;
  dynamics::State nothing_;  ///< a State without blocks: obstacles and the tool are all there is
  contact::FrameLinearisation linear_;
  bool in_tick_ = false, rubs_ = false;  ///< between with() and end_tick(); and with friction
  dynamics::RigidMotion start_;          ///< of the tick
};

}  // namespace palpate::loop
