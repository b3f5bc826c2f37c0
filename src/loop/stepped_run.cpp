#include "palpate/loop/stepped_run.h"

#include "core/clock.h"
#include "palpate/core/error.h"
#include "palpate/core/workers.h"
#include "virtual_time.h"

namespace palpate::loop {

struct SteppedRun::Impl {
  Impl(World& world_in, RunOptions options_in)
      : world(world_in),
        options(std::move(options_in)),
        bodies(world, options, result),
        clock(world, bodies, options, result) {}
  Impl(World& world_in, RunOptions options_in, Archive& from)
      : world(world_in),
        options(std::move(options_in)),
        bodies(world, options, result),
        clock(world, bodies, options, result, from) {}
  World& world;
  RunOptions options;
  RunResult result;
  BodyLoop bodies;
  VirtualTime clock;
  bool over = false;
};

SteppedRun::SteppedRun(World& world, RunOptions options)
    : impl_(std::make_unique<Impl>(world, std::move(options))) {}

SteppedRun::SteppedRun(World& world, RunOptions options, Archive& from) {
  const workers::Count threads(world.description.integrator.threads);
  impl_ = std::make_unique<Impl>(world, std::move(options), from);
}

SteppedRun::~SteppedRun() {
  impl_->clock.end();
  impl_->bodies.finish();
}

bool SteppedRun::next() {
  Impl& run = *impl_;
  if (run.over) return false;
  const workers::Count threads(run.world.description.integrator.threads);
  const double wall = wall_seconds(), cpu = cpu_seconds();
  run.over = true;  // stays true if next() throws
  run.over = !run.clock.next();
  run.result.wall_s += wall_seconds() - wall;
  run.result.cpu_s += cpu_seconds() - cpu;
  run.bodies.sum_up();
  return !run.over;
}

const RunResult& SteppedRun::result() const { return impl_->result; }
double SteppedRun::duration() const { return impl_->bodies.duration(); }
double SteppedRun::period() const { return impl_->bodies.period(); }
int SteppedRun::periods_done() const { return impl_->clock.periods(); }
int SteppedRun::periods() const { return impl_->bodies.periods(); }

void SteppedRun::archive(Archive& a) {
  PALPATE_CHECK(!a.is_restoring(), "a SteppedRun can only be restored by its constructor");
  const workers::Count threads(impl_->world.description.integrator.threads);
  impl_->bodies.query_before_checkpoint();
  impl_->clock.archive(a);
}

}  // namespace palpate::loop
