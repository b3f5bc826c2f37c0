#include "simulation.h"

#include <fmt/format.h>

#include <cmath>

#include "palpate/core/error.h"
#include "palpate/scene/hands.h"

namespace palpate::python {

TickLists::TickLists(std::size_t hands) {
  for (std::size_t i = 0; i < hands; ++i) {
    lists_.push_back(std::make_shared<std::vector<loop::TickRecord>>());
    lists_.back()->reserve(1024);
  }
}

void TickLists::tick_of(std::size_t hand, const loop::TickRecord& tick) {
  auto& list = lists_.at(hand);
  if (list->size() == list->capacity()) {
    auto longer = std::make_shared<std::vector<loop::TickRecord>>();
    longer->reserve(2 * list->size());
    *longer = *list;  // Within the reserved capacity.
    list = std::move(longer);
  }
  list->push_back(tick);
}

Simulation::Simulation(const scene::Description& description, double duration_s)
    : world_(loop::assemble(description)),
      ticks_(std::make_unique<TickLists>(scene::hands_of(world_->description).size())) {
  if (!(duration_s >= 0.0)) fail("duration_s = {} must be positive, or 0 for the scene's", duration_s);
  loop::RunOptions options;
  options.duration_s = duration_s;
  options.observers = {ticks_.get()};
  options.stop = &stop_;
  run_ = std::make_unique<loop::SteppedRun>(*world_, options);
}

Simulation::Lease::Lease(Simulation& simulation) : busy_(simulation.busy_) {
  if (busy_.exchange(true)) fail("this simulation is being stepped by another thread");
}

bool Simulation::finished() const { return time_ >= duration() * (1.0 - 1e-12); }

bool Simulation::next() {
  if (run_->next()) {
    time_ = result().time;
    return true;
  }
  const dynamics::StepResult& last = result().status;
  if (!last.ok())
    throw StepFailure(
        fmt::format("{} failed at t = {:g} s: {}; a smaller tolerance or step often helps "
                    "(integrator.rtol, integrator.step_s)",
                    world_->description.integrator.name, last.t, last.message));
  if (result().stopped)
    fail("the simulation was stopped at t = {:g} s, within a period; create a new one", result().time);
  return false;
}

bool Simulation::step() {
  const Lease lease(*this);
  return next();
}

void Simulation::advance(double seconds) {
  if (!(seconds > 0.0)) fail("advance({}): must be positive [s]", seconds);
  const Lease lease(*this);
  const double end = result().time + seconds;
  while (result().time < end * (1.0 - 1e-12) && next()) {}
}

void Simulation::run() {
  const Lease lease(*this);
  while (next()) {}
}

}  // namespace palpate::python
