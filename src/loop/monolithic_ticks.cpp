#include "monolithic_ticks.h"

#include "palpate/core/error.h"
#include "tool_instance.h"

namespace palpate::loop {
namespace {

/// Tolerance for equal times, relative to a tick: ticks and output times are multiples of different decimal
/// numbers.
constexpr double kSameTick = 1e-6;

}  // namespace

TickRecord tick_at(const World& world, const ToolInstance& tool, double t, const dynamics::StateView& state) {
  const MonolithicTool& of_tool = *tool.monolithic();
  const dynamics::RigidMotion motion = of_tool.motion(state);
  TickRecord tick;
  tick.time = t;
  tick.tool = motion.pose;
  tick.tool_twist = motion.twist;
  if (const auto& hand = of_tool.hand) {
    const tool::HandleState handle = tool::hand_motion(state, hand->block_id, hand->block);
    tick.handle = handle.pose;
    tick.handle_twist = handle.twist;
    tick.switches = hand->model.requested(t).switches;
  }
  if (tool.frame >= 0) tick.contact = world.contact->frame_wrench(state, tool.frame);
  return tick;
}

MonolithicTicks::MonolithicTicks(World& world, Emit emit)
    : world_(world), emit_(std::move(emit)), tick_s_(world.description.tool->tick_s) {
  PALPATE_CHECK(world.monolithic() && world.stepper,
                "monolithic ticks need a tool that is a block of the State");
  follows_ = world.stepper->follow(this);
}

MonolithicTicks::~MonolithicTicks() {
  if (follows_) world_.stepper->follow(nullptr);
}

bool MonolithicTicks::due(double t) const { return next() <= t + kSameTick * tick_s_; }

dynamics::StepResult MonolithicTicks::advance_to(double t1) {
  if (follows_) return world_.stepper->advance_to(t1);
  dynamics::StepResult result;
  while (result.ok() && due(t1)) {
    const double t = std::min(next(), t1);
    if (t > world_.state.time()) result = world_.stepper->advance_to(t);
    if (result.ok()) emit_at(next(), world_.state.view());
  }
  if (result.ok() && t1 > world_.state.time()) result = world_.stepper->advance_to(t1);
  return result;
}

void MonolithicTicks::stepped(const dynamics::Stepper& stepper, double t0, double t1) {
  while (due(t1)) {
    const double t = std::clamp(next(), t0, t1);
    PALPATE_CHECK(stepper.dense_output(t, q_, u_),
                  "{} has no dense output at t = {} within its step from {} to {}", stepper.name(), t, t0,
                  t1);
    emit_at(next(), dynamics::make_view(world_.state.layout(), t, q_.data(), u_.data()));
  }
}

void MonolithicTicks::emit_at(double t, const dynamics::StateView& state) {
  ++count_;
  for (std::size_t i = 0; i < world_.tools.size(); ++i) emit_(i, tick_at(world_, world_.tools[i], t, state));
}

}  // namespace palpate::loop
