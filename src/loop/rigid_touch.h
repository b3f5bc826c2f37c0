#pragma once
#include <Eigen/LU>
#include <cmath>
#include <span>
#include <vector>

#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/exchange.h"
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/dynamics/state.h"
#include "palpate/tool/tool.h"

namespace palpate::loop {

/// Contact of tools of ticks with obstacles and with each other.  No body answers it, so that it needs no
/// exchange: it is linear about the tools as they are at each tick.  It knows no World, and belongs to the
/// ticks' thread.
class RigidTouch {
 public:
  /// @param look_ahead_s  for how long a query finds what may touch: the next is due then
  explicit RigidTouch(double look_ahead_s);
  /// Takes another tool; returns its number, from 0.  Of those in one object any two may meet, and all have
  /// ticks at the same times.
  int add(const ToolSpec& tool);
  int size() const { return static_cast<int>(tools_.size()); }
  double look_ahead() const { return look_ahead_; }

  /// Returns the contact that takes pairs; frame() and motion() are a tool's in it.
  contact::ContactForce& contact() { return contact_; }
  int frame(int tool) const { return tools_[static_cast<std::size_t>(tool)].frame; }
  std::shared_ptr<contact::MovingFrame> motion(int tool) const;

  /// Begins a tick.  Queries follow from its time and from those before, so that the same ticks make the same
  /// queries; one that finds more than any before takes memory.
  /// @param t  at its start [s]  @param tools  then, in their order
  void begin_tick(double t, std::span<const dynamics::RigidMotion> tools);
  /// Whether something with friction touches in the tick under way.
  bool rubs() const { return rubs_; }
  /// Whether a tool touches something then.
  bool touches() const;
  /// Returns a tool's record of the bodies, linear about the tool's pose and twist at the tick's start.
  dynamics::LinearisedContact about_now(int tool, const dynamics::LinearisedContact& record) const;
  /// Solves for the change of all twists over the tick of length h, by linearly implicit Euler's method.
  /// @param equations  of each tool under all else that acts on it, the bodies' as about_now() made it
  void solve(double h, std::span<const tool::StepEquation> equations);
  /// Change of a tool's twist, as solve() found it [rad/s, m/s].
  Vec6 change(int tool) const { return change_.segment<6>(6 * tool); }
  /// Takes the tools' ends, as solve() found them, for the next guess of friction.  False: friction is not
  /// the law's at these ends.
  bool improve();
  /// Contact about that guess.
  void again();
  /// Returns that record with this contact, in which the other tools go where solve() says.
  dynamics::LinearisedContact with(int tool, const dynamics::LinearisedContact& record) const;
  void end_tick();
  /// The next tick queries, whether a query is due or not: then nothing of the ticks before is needed.
  void query_next() { due_ = -HUGE_VAL; }

 private:
  struct OneTool {
    int block_id = -1, frame = -1;
    contact::FrameLinearisation contact;
    Vec6 by_others = Vec6::Zero();  ///< wrench, for the other tools move within the tick
  };
  void place(double t, std::span<const dynamics::RigidMotion> tools);

  double look_ahead_, due_ = -HUGE_VAL;
  contact::ContactForce contact_;
  dynamics::State state_;  ///< a block for each tool
  std::vector<OneTool> tools_;
  bool rubs_ = false;     ///< in the tick under way
  VecX moved_, change_;   ///< of all tools over the tick, along u-directions [rad, m; rad/s, m/s]
  VecX rhs_, one_, sum_;  ///< scratch
  dynamics::BorderedMatrix joint_;
  Eigen::PartialPivLU<MatX> lu_;
};

}  // namespace palpate::loop
