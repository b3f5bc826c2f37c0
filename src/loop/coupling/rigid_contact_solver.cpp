// Tools that meet in a tick. With all other forces, tool i has the linearly implicit step A_i du_i = r_i
// (tool/fixed_tick.cpp). Contact of tools with each other and with obstacles adds the wrenches
//
//     F_i - sum_j (K_ij dx_j + B_ij du_j),     dx_j = h (u_j + du_j),
//
// with K and B the negative derivatives of F at the start of the tick; obstacles are tools that do not move.
// The ends of all tools therefore follow from one linear system with 6 equations per tool,
//
//     A_i du_i + sum_j (h B_ij + h^2 K_ij) du_j = r_i + h (F_i - h sum_j K_ij u_j),
//
// which does not bound the stiffness of contact without friction. (Solving each tool against the present or
// extrapolated positions of the others requires h^2 k < 2 m. With friction there is a bound: a box between
// another box and the floor keeps its motion at 1e10 Pa/m and ticks of 1 ms, and loses it at 1e11, where
// ticks of 0.2 ms keep it.) The record for the scheme of each tool then contains the derivatives by this
// tool's motion, and the others' part as a constant:
//
//     F_i - sum_{j != i} (K_ij dx_j + B_ij du_j) - K_ii dx_i - B_ii du_i.
//
// With linearly implicit Euler the resulting tick is the solution of that system: the forces of two tools on
// each other are opposite to rounding. For other schemes they differ by as much as the scheme differs from
// linearly implicit Euler.
#include "rigid_contact_solver.h"

#include <algorithm>

#include "coupled_tool.h"
#include "palpate/core/error.h"

namespace palpate::loop {

RigidContactSolver::RigidContactSolver(double look_ahead_s) : look_ahead_(look_ahead_s) {}

int RigidContactSolver::add(const ToolSpec& tool) {
  const Quat r = quaternion_of(tool.rotation_vector_rad);
  VecX q(7);
  q << r.w(), r.vec(), tool.position_m;
  tools_.emplace_back().block_id = state_.insert(dynamics::rigid_block("tool", 1.0, 1.0), q, VecX::Zero(6));
  tools_.back().frame = contact_.add_frame(motion(size() - 1));
  change_.setZero(6 * size());
  return size() - 1;
}

std::shared_ptr<contact::MovingFrame> RigidContactSolver::motion(int tool) const {
  return contact::block_frame(tools_[static_cast<std::size_t>(tool)].block_id);
}

void RigidContactSolver::place(double t, std::span<const dynamics::RigidMotion> tools) {
  PALPATE_CHECK(tools.size() == tools_.size(), "{} tool motions given for {} tools", tools.size(),
                tools_.size());
  state_.set_time(t);
  for (std::size_t i = 0; i < tools.size(); ++i) {
    const Pose& pose = tools[i].pose;
    const auto at = static_cast<Eigen::Index>(i);
    state_.q().segment<7>(7 * at) << pose.rotation.w(), pose.rotation.vec(), pose.translation;
    state_.u().segment<6>(6 * at) = stacked(tools[i].twist);
  }
}

void RigidContactSolver::begin_tick(double t, std::span<const dynamics::RigidMotion> tools) {
  place(t, tools);
  // Ticks add up their lengths: a query is due at the tick nearest to its time.
  if (t >= due_ - 1e-6 * look_ahead_) {
    contact_.refresh(state_.view());
    due_ = t + look_ahead_;
  }
  rubs_ = contact_.begin_step(state_.view());
  relinearise();
}

void RigidContactSolver::relinearise() {
  for (OneTool& tool : tools_) {
    tool.by_others.setZero();
    contact_.linearise(state_.view(), tool.frame, tool.contact, contact::Partners::kFrames);
  }
}

void RigidContactSolver::solve(double h, std::span<const tool::StepEquation> equations) {
  const dynamics::StateView at = state_.view();
  const auto rows = static_cast<Eigen::Index>(6 * tools_.size());
  joint_.right.resize(0, rows);
  joint_.bottom.resize(rows, 0);
  joint_.corner.setZero(rows, rows);
  contact_.add_tangent(at, h * h, h, joint_);
  rhs_.resize(rows);
  sum_.setZero(rows);
  one_ = state_.u();
  contact_.apply_tangent(at, 1.0, 0.0, one_, sum_);
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    const Wrench& wrench = tools_[i].contact.wrench;
    joint_.corner.block<6, 6>(row, row) += equations[i].A;
    rhs_.segment<3>(row) = h * wrench.moment;
    rhs_.segment<3>(row + 3) = h * wrench.force;
    rhs_.segment<6>(row) += equations[i].r - h * h * sum_.segment<6>(row);
  }
  lu_.compute(joint_.corner);
  change_ = lu_.solve(rhs_);
  moved_ = h * (state_.u() + change_);
  // K_ij dx_j + B_ij du_j = (h B_ij + h^2 K_ij) du_j/h + h K_ij u_j
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    Vec6 sum = h * (sum_.segment<6>(row) - tools_[i].contact.K * state_.u().segment<6>(row));
    for (Eigen::Index other = 0; other < rows; other += 6)
      if (other != row)
        sum += joint_.corner.block<6, 6>(row, other).lazyProduct(change_.segment<6>(other)) / h;
    tools_[i].by_others = -sum;
  }
}

bool RigidContactSolver::update_friction() {
  return !rubs_ || contact_.improve_step(state_.view(), moved_, change_);
}

void RigidContactSolver::end_tick() {
  if (rubs_) contact_.end_step();
  rubs_ = false;
}

bool RigidContactSolver::touches() const {
  return std::any_of(tools_.begin(), tools_.end(),
                     [](const OneTool& tool) { return tool.contact.active > 0; });
}

// A record R(t, x, v) that is linear about (x0, v0) is linear about the present (x, v) with the same F1, J
// and B:
//     R(t + s, x + dx, v + dv) = R(t, x, v) + s F1 + J dx + B dv,
// up to second order in the rotation from x0.
dynamics::LinearisedContact RigidContactSolver::about_now(int tool,
                                                          const dynamics::LinearisedContact& record) const {
  const auto q = state_.q().segment<7>(7 * tool);
  const auto u = state_.u().segment<6>(6 * tool);
  const Pose pose{Quat(q[0], q[1], q[2], q[3]), q.tail<3>()};
  dynamics::LinearisedContact out = record;
  const Twist twist{u.head<3>(), u.tail<3>()};
  set_reference(out, state_.time(), pose, twist);
  Eigen::Map<Vec6>(out.F0.data()) = dynamics::contact_wrench(record, out.time, pose, twist);
  return out;
}

dynamics::LinearisedContact RigidContactSolver::with(int tool,
                                                     const dynamics::LinearisedContact& record) const {
  using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  const OneTool& mine = tools_[static_cast<std::size_t>(tool)];
  Vec6 wrench = mine.by_others;
  wrench.head<3>() += mine.contact.wrench.moment;
  wrench.tail<3>() += mine.contact.wrench.force;
  dynamics::LinearisedContact out = about_now(tool, record);
  Eigen::Map<Vec6>(out.F0.data()) += wrench;
  Eigen::Map<RowMajor6>(out.J.data()) -= mine.contact.K;
  Eigen::Map<RowMajor6>(out.B.data()) -= mine.contact.B;
  out.samples += mine.contact.active;
  if (out.source == dynamics::LinearisedContact::Source::kNone)
    out.source = dynamics::LinearisedContact::Source::kFrozen;
  return out;
}

}  // namespace palpate::loop
