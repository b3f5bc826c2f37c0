#include "single_rate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "monolithic_ticks.h"
#include "palpate/core/error.h"

namespace palpate::loop {

SingleRate::SingleRate(World& world, BodyLoop& bodies, const RunResult& result,
                       std::vector<HapticLoop*> loops)
    : world_(world),
      bodies_(bodies),
      result_(result),
      loops_(std::move(loops)),
      per_period_(whole_number(bodies.period() / world.description.tool->tick_s)),
      tick_s_(bodies.period() / per_period_),
      count_(std::max(1L, std::lround(bodies.duration() / tick_s_))) {
  PALPATE_CHECK(world.monolithic() && world.stepper && loops_.size() == world.tools.size(),
                "ticks of a single rate need tools that are blocks of the State");
}

namespace {
/// Tolerance for equal times, relative to a period: ticks and periods are multiples of different decimal
/// numbers.
constexpr double kSameQuery = 1e-9;
}  // namespace

double SingleRate::time_of(long tick) const {
  if (tick >= count_) return bodies_.duration();
  return bodies_.period_start(static_cast<int>(tick / per_period_)) +
         static_cast<double>(tick % per_period_) * tick_s_;
}

void SingleRate::start() {
  query_if_due(0.0, bodies_.period());
  world_.stepper->prepare(tick_s_);
}

void SingleRate::query_if_due(double t, double period_end) {
  if (t < next_query_ - kSameQuery * period_end) return;
  bodies_.query();
  next_query_ = bodies_.next_query(t, period_end);
}

void SingleRate::tick(double t0, double t1) {
  for (HapticLoop* loop : loops_) loop->begin_step(t0, t1);
  bodies_.advance(t0, t1, t1 - t0);
  if (!result_.status.ok()) return;
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    TickRecord record = tick_at(world_, world_.tools[i], t1, world_.state.view());
    record.length = t1 - t0;
    record.left_out = static_cast<std::uint32_t>(left_out_);
    loops_[i]->render_force(record);
    bodies_.record_tick(i, record);
  }
  left_out_ = 0;
}

void SingleRate::mark(bool ramps_in, long left_out) {
  left_out_ = left_out;
  if (!ramps_in) return;
  for (HapticLoop* loop : loops_) loop->ramp_in();
}

}  // namespace palpate::loop
