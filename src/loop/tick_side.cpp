#include "tick_side.h"

#include "palpate/tool/rigid_block.h"

namespace palpate::loop {

TickSide::TickSide(const ToolSpec& spec, ToolSide& side) : spec_(spec), side_(side) {}

TickSide::~TickSide() {
  try {
    end();
  } catch (...) {}  // the device failed: it is what the run reports
}

void TickSide::start(double t) { side_.handle_now = handle_ = side_.handle->sample(t); }

dynamics::StepResult TickSide::tick(double t, double h, const dynamics::LinearisedContact& record,
                                    TickRecord& out) {
  const device::HandleSample before = handle_, now = side_.handle->sample(t);
  dynamics::StepResult status =
      side_.tool->advance(h, {before.pose, now.pose, before.twist, now.twist}, record);
  if (!status.ok()) return status;
  out = {};
  out.time = t;
  out.length = h;
  out.tool = side_.tool->pose();
  out.tool_twist = side_.tool->twist();
  out.record_version = record.version;
  const Vec6 contact = dynamics::contact_wrench(record, t, out.tool, out.tool_twist);
  out.contact = {contact.head<3>(), contact.tail<3>()};
  handle_ = now;
  feel_at(out);
  return status;
}

void TickSide::feel(TickRecord& tick) {
  handle_ = side_.handle->sample(tick.time);
  feel_at(tick);
}

void TickSide::feel_at(TickRecord& tick) {
  tick.handle = handle_.pose;
  tick.handle_twist = handle_.twist;
  tick.handle_valid = handle_.valid;
  tick.wanted = tool::coupling_on_hand(spec_, {tick.tool, tick.tool_twist}, {handle_.pose, handle_.twist});
  tick.device = side_.limiter->limit(tick.time, tick.wanted, handle_.valid);
  if (side_.passivity)
    tick.device = side_.passivity->apply(tick.time, tick.handle, tick.device, handle_.valid);
  live_ = true;
  time_ = tick.time;
  side_.handle->feedback(tick.time, tick.device);
}

void TickSide::end() {
  if (!live_) return;
  live_ = false;
  side_.handle->feedback(time_, {});
}

}  // namespace palpate::loop
