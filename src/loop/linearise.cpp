#include "linearise.h"

#include <algorithm>

#include "condenser.h"
#include "palpate/contact/contact_force.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/tool/tool.h"
#include "tool_side.h"

namespace palpate::loop {

namespace {

using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

// The wrench on the tool over the period has two parts.  While the tool goes on with its velocity v0, the
// wrench is a line through the results of one implicit step after one tick and after the period; J and B of
// the period give the response to any deviation from that motion.  After a time s (tick or period) the first
// part is w(s) + s J(s) v0:
//     line(s) = W0 + s S,
//     F = line + J (dx - s v0) + B (v - v0) = W0 + s (S - J v0) + J dx + B (v - v0).
// A contact whose nodes move within a tick answers it more stiffly than it answers the period, and the tool's
// own way is where that shows: with J of the period for all of dx, the error stood still between periods of 5
// and 2.5 ms. A stiff contact that the last period has left out of balance is relaxed within the first tick,
// as it is in the bodies' own implicit step, where a line that began at the present wrench would press with
// it for half the period.  Where nothing is stiff, it begins there to O(tick^2).
bool condense(World& world, double period, const contact::FrameLinearisation& c,
              dynamics::LinearisedContact& record) {
  const double tick = std::min(world.description.tool->tick_s, period);
  CondensedAnswer last, first;
  if (!ToolSide::of(world).condenser->answer(world, period, tick, c, last, first)) return false;
  Vec6 F0 = last.wrench, F1 = Vec6::Zero();
  if (tick < period * (1.0 - 1e-9)) {
    const Twist twist = ToolSide::of(world).tool->twist();
    Vec6 v0;
    v0 << twist.angular, twist.linear;
    const Vec6 after_tick = first.wrench + tick * (first.J * v0),
               after_period = last.wrench + period * (last.J * v0);
    const Vec6 slope = (after_period - after_tick) / (period - tick);
    F0 = after_tick - tick * slope;
    F1 = slope - last.J * v0;
  }
  Eigen::Map<Vec6>(record.F0.data()) = F0;
  Eigen::Map<Vec6>(record.F1.data()) = F1;
  Eigen::Map<RowMajor6>(record.J.data()) = last.J;
  Eigen::Map<RowMajor6>(record.B.data()) = last.B;
  record.source = dynamics::LinearisedContact::Source::kCondensed;
  return true;
}

/// As LinearisedContact has it.
std::array<double, 7> flat(const Pose& pose) {
  return {pose.rotation.w(),    pose.rotation.x(),    pose.rotation.y(),   pose.rotation.z(),
          pose.translation.x(), pose.translation.y(), pose.translation.z()};
}

}  // namespace

dynamics::LinearisedContact linearise_contact(World& world, std::uint64_t version, double period_s,
                                              long& frozen_fallbacks) {
  counters::count("loop.exchange_record");
  const ToolSide& side = ToolSide::of(world);
  dynamics::LinearisedContact record;
  record.version = version;
  record.time = world.state.time();
  if (!side.trajectory) return record;
  contact::FrameLinearisation c;
  world.contact->linearise(world.state.view(), side.frame_index, c, contact::Partners::kNodes);
  record.samples = c.active;
  const Pose x0 = side.tool->pose();
  const Twist v0 = side.tool->twist();
  record.x0 = flat(x0);
  Eigen::Map<Vec6>(record.v0.data()) << v0.angular, v0.linear;
  Eigen::Map<Vec6>(record.F0.data()) << c.wrench.moment, c.wrench.force;
  Eigen::Map<RowMajor6>(record.J.data()) = -c.K;
  Eigen::Map<RowMajor6>(record.B.data()) = -c.B;
  record.source = dynamics::LinearisedContact::Source::kFrozen;
  if (side.condenser && c.active > 0 && !condense(world, period_s, c, record)) ++frozen_fallbacks;
  return record;
}

// The record R(t, x, v) is linear about (x0, v0); it goes on about (x, v) = now with the same F1, J and B:
//     R(t + s, x + dx, v + dv) = R(t, x, v) + s F1 + J dx + B dv,
// up to the second order in the rotation from x0.  To it come the obstacles' F, -K and -B, about (x, v).
dynamics::LinearisedContact with_obstacles(const World& world, const dynamics::LinearisedContact& record) {
  const ToolSide& side = ToolSide::of(world);
  const double t = side.tool->time();
  contact::FrameLinearisation c;
  world.contact->linearise(world.state.view(t, world.state.q().data(), world.state.u().data()),
                           side.frame_index, c, contact::Partners::kFrames);
  if (c.active == 0) return record;
  dynamics::LinearisedContact out = record;
  const Pose x = side.tool->pose();
  const Twist v = side.tool->twist();
  Vec6 wrench;
  wrench << c.wrench.moment, c.wrench.force;
  out.time = t;
  out.x0 = flat(x);
  Eigen::Map<Vec6>(out.v0.data()) << v.angular, v.linear;
  Eigen::Map<Vec6>(out.F0.data()) = dynamics::contact_wrench(record, t, x, v) + wrench;
  Eigen::Map<RowMajor6>(out.J.data()) -= c.K;
  Eigen::Map<RowMajor6>(out.B.data()) -= c.B;
  out.samples += c.active;
  return out;
}

}  // namespace palpate::loop
