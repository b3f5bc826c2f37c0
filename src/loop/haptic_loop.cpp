#include "haptic_loop.h"

#include <algorithm>
#include <utility>

#include "tool/rigid_block.h"

namespace palpate::loop {

HapticLoop::HapticLoop(ToolInstance& tool, const std::vector<ContactSpec>* laws)
    : tool_(tool), partitioned_(tool.partitioned()) {
  if (laws) touch_.emplace(*laws);
}

HapticLoop::HapticLoop(const scene::Description& description, ToolInstance& tool)
    : HapticLoop(tool, tool.partitioned() && description.exchange.linearisation == "points"
                           ? &description.contacts
                           : nullptr) {}

HapticLoop::~HapticLoop() {
  try {
    end();
  } catch (...) {}  // the device failed, which the run reports
}

void HapticLoop::start(double t) {
  tool_.handle = handle_ = tool_.device->sample(t);
  time_ = t;
  hold_handle();
}

/// Passes the last sample to a coupling in the State, until the next step begins.
void HapticLoop::hold_handle() {
  const MonolithicTool* const tool = tool_.monolithic();
  if (tool && tool->sampled) tool->sampled->set(time_, handle_, time_, handle_);
}

void HapticLoop::archive(Archive& a) {
  a("handle", handle_);
  a("time", time_);
  a("live", live_);
  if (a.is_restoring()) hold_handle();
  if (!touch_) return;
  a("touch", *touch_);
  a("taken_up", active_version_);
  a("ticks", count_);
  a.rows("past", past_, [](auto&& f, Past& past) {
    f(past.time);
    f(past.length);
    f(past.tool.pose);
    f(past.tool.twist);
  });
}

// A late record is advanced in strides of several ticks, for which implicit Euler is stable, too; otherwise
// the tick that adopts it would cost as much as all ticks by which it is late. The tool's motion at the
// end of a stride is known: the contact is linearised there, as if the tool had moved with its last twist
// during the stride.
void HapticLoop::adopt_model(const ContactRecord& record) {
  constexpr std::size_t kMostStrides = 8;
  active_version_ = record.linear.version;
  touch_->adopt(record.touch);
  const auto past = [&](std::size_t i) -> const Past& { return past_[i % past_.size()]; };
  std::size_t first = count_ - std::min(count_, past_.size());
  while (first < count_ && past(first).time - 0.5 * past(first).length < record.touch.time) ++first;
  const std::size_t stride = (count_ - first + kMostStrides - 1) / kMostStrides;
  for (std::size_t last; first < count_; first = last + 1) {
    last = std::min(first + stride, count_) - 1;
    double length = 0.0;
    for (std::size_t i = first; i <= last; ++i) length += past(i).length;
    const dynamics::RigidMotion& tool = past(last).tool;
    const Pose before{quaternion_of(-length * tool.twist.angular) * tool.pose.rotation,
                      tool.pose.translation - length * tool.twist.linear};
    touch_->linearise(past(last).time, length, {before, tool.twist});
    while (!touch_->update_friction(tool)) touch_->relinearise();
    touch_->follow(tool);
  }
}

tool::HandleMotion HapticLoop::handle_motion() const {
  return {handle_.pose, next_->pose, handle_.twist, next_->twist};
}

void HapticLoop::begin_tick(double t, double h, const ContactRecord& record) {
  next_ = tool_.device->sample(t);
  of_bodies_ = record.linear;
  if (record.linear.source != dynamics::LinearisedContact::Source::kPoints) return;
  if (record.linear.version != active_version_) adopt_model(record);
  of_bodies_ = touch_->linearise(t, h, {partitioned_->tool.pose(), partitioned_->tool.twist()});
  of_bodies_.version = record.linear.version;
}

bool HapticLoop::has_friction() const {
  return of_bodies_.source == dynamics::LinearisedContact::Source::kPoints && touch_->has_friction();
}

tool::StepEquation HapticLoop::equation(double h, const dynamics::LinearisedContact& contact) const {
  return partitioned_->tool.step_equation(h, handle_motion(), contact);
}

bool HapticLoop::update_friction(double h, const Vec6& change) {
  return !has_friction() || touch_->update_friction(partitioned_->tool.after(h, change));
}

void HapticLoop::relinearise() {
  if (!has_friction()) return;
  const std::uint64_t version = of_bodies_.version;
  of_bodies_ = touch_->relinearise();
  of_bodies_.version = version;
}

dynamics::StepResult HapticLoop::tick(double t, double h, const dynamics::LinearisedContact& contact,
                                      TickRecord& out) {
  if (!next_) next_ = tool_.device->sample(t);
  const device::HandleSample now = *next_;
  dynamics::StepResult status = partitioned_->tool.advance(h, handle_motion(), contact);
  next_.reset();
  if (!status.ok()) return status;
  out = {};
  out.time = t;
  out.length = h;
  out.tool = partitioned_->tool.pose();
  out.tool_twist = partitioned_->tool.twist();
  out.record_version = contact.version;
  if (touch_) {
    past_[count_++ % past_.size()] = {t, h, {out.tool, out.tool_twist}};
    if (contact.source == dynamics::LinearisedContact::Source::kPoints)
      touch_->follow({out.tool, out.tool_twist});
  }
  const Vec6 wrench = dynamics::contact_wrench(contact, t, out.tool, out.tool_twist);
  out.contact = {wrench.head<3>(), wrench.tail<3>()};
  handle_ = now;
  send_wrench(out);
  return status;
}

bool HapticLoop::hand_in_state() const {
  const MonolithicTool* const tool = tool_.monolithic();
  return tool && tool->hand;
}

void HapticLoop::begin_step(double t0, double t1) {
  next_ = tool_.device->sample(t1);
  tool_.monolithic()->sampled->set(t0, handle_, t1, *next_);
}

void HapticLoop::render_force(TickRecord& tick) {
  if (hand_in_state())
    handle_ = {tick.handle, tick.handle_twist, {}, true, tick.switches};
  else
    handle_ = next_ ? *next_ : tool_.device->sample(tick.time);
  next_.reset();
  send_wrench(tick);
}

void HapticLoop::send_wrench(TickRecord& tick) {
  tick.handle = handle_.pose;
  tick.handle_twist = handle_.twist;
  tick.handle_valid = handle_.valid;
  tick.switches = handle_.switches;
  tick.requested =
      tool::coupling_on_hand(tool_.spec, {tick.tool, tick.tool_twist}, {handle_.pose, handle_.twist});
  tool_.motors.advance(tick.time);
  tick.motors = tool_.motors.mean();
  tick.ramps_in = std::exchange(ramps_in_, false);
  if (tick.ramps_in) tool_.limiter.restart();
  const long limited_before = tool_.limiter.limited_ticks();
  tick.device = tool_.limiter.limit(tick.time, tick.requested, handle_.valid);
  tick.limited = tool_.limiter.limited_ticks() > limited_before;
  if (tool_.passivity)
    tick.device = tool_.passivity->apply(tick.time, tick.handle, tool_.motors, tick.device, handle_.valid);
  tool_.motors.send(tick.time, tick.device);
  live_ = true;
  time_ = tick.time;
  if (!hand_in_state()) tool_.device->feedback(tick.time, tick.device);
}

void HapticLoop::end() {
  if (!live_) return;
  live_ = false;
  tool_.device->feedback(time_, {});
}

}  // namespace palpate::loop
