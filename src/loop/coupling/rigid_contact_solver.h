#pragma once
#include <Eigen/LU>
#include <cmath>
#include <span>
#include <vector>

#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/linearised_contact.h"
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/dynamics/state.h"
#include "palpate/tool/tool.h"

namespace palpate::loop {

/// Contact of tools with ticks with obstacles and with each other. No soft body is involved, so no exchange
/// is needed: the contact is linearised about the tools at each tick. It does not depend on the World, and
/// belongs to the tick thread.
class RigidContactSolver {
 public:
  /// @param look_ahead_s  time between queries, for which a query collects contact candidates [s]
  explicit RigidContactSolver(double look_ahead_s);
  /// Adds one tool and returns its index, from 0. All tools of one object may meet, and have ticks at the
  /// same times.
  int add(const ToolSpec& tool);
  int size() const { return static_cast<int>(tools_.size()); }
  double look_ahead() const { return look_ahead_; }

  /// Returns the contact to which pairs are added; frame() and motion() refer to it.
  contact::ContactForce& contact() { return contact_; }
  int frame(int tool) const { return tools_[static_cast<std::size_t>(tool)].frame; }
  std::shared_ptr<contact::MovingFrame> motion(int tool) const;

  /// Begins one tick. Query times depend only on the times of the ticks, so that equal ticks make equal
  /// queries. A query that finds more candidates than any before allocates memory.
  /// @param t  start of the tick [s]  @param tools  motions at t, in the tools' order
  void begin_tick(double t, std::span<const dynamics::RigidMotion> tools);
  /// Returns whether a contact with friction is active in the current tick.
  bool has_friction() const { return rubs_; }
  /// Returns whether a tool has contact in the current tick.
  bool touches() const;
  /// Returns the record of the bodies for one tool, linearised about the tool's pose and twist at the
  /// start of the tick.
  dynamics::LinearisedContact about_now(int tool, const dynamics::LinearisedContact& record) const;
  /// Solves for the changes of all twists over a tick of length h by linearly implicit Euler.
  /// @param equations  equation per tool with all other forces, for the bodies' record from about_now()
  void solve(double h, std::span<const tool::StepEquation> equations);
  /// Returns the change of a tool's twist from solve() [rad/s, m/s].
  Vec6 change(int tool) const { return change_.segment<6>(6 * tool); }
  /// Updates friction from the ends of the tools that solve() computed. Returns false if friction does not
  /// yet satisfy its law there.
  bool update_friction();
  /// Linearises contact with the updated friction.
  void relinearise();
  /// Returns the record plus this contact, in which the other tools move as solve() computed.
  dynamics::LinearisedContact with(int tool, const dynamics::LinearisedContact& record) const;
  /// Ends the tick.
  void end_tick();
  /// Makes the next tick query contact, so that it does not depend on the ticks before.
  void query_next() { due_ = -HUGE_VAL; }

 private:
  struct OneTool {
    int block_id = -1, frame = -1;
    contact::FrameLinearisation contact;
    Vec6 by_others = Vec6::Zero();  ///< Wrench due to the motion of the other tools within the tick.
  };
  void place(double t, std::span<const dynamics::RigidMotion> tools);

  double look_ahead_, due_ = -HUGE_VAL;
  contact::ContactForce contact_;
  dynamics::State state_;  ///< One block per tool.
  std::vector<OneTool> tools_;
  bool rubs_ = false;     ///< Friction in the current tick.
  VecX moved_, change_;   ///< Displacements and twist changes of all tools over the tick, along u-directions
                          ///< [rad, m; rad/s, m/s].
  VecX rhs_, one_, sum_;  ///< Scratch.
  dynamics::BorderedMatrix joint_;
  Eigen::PartialPivLU<MatX> lu_;
};

}  // namespace palpate::loop
