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

Simulation::Simulation(const scene::Description& description, SimulationOptions requested)
    : world_(loop::assemble(description, std::move(requested.hands))),
      ticks_(std::make_unique<TickLists>(scene::hands_of(world_->description).size())) {
  if (!(requested.duration_s >= 0.0))
    fail("duration_s = {} must be positive, or 0 for the scene's", requested.duration_s);
  if (requested.external_forces) external_forces_ = add_external_forces(*world_);
  loop::RunOptions options;
  options.duration_s = requested.duration_s;
  options.observers = {ticks_.get()};
  if (requested.energy) options.observers.push_back(&balance_.emplace());
  options.stop = &stop_;
  run_ = std::make_unique<loop::SteppedRun>(*world_, options);
}

Simulation::Lease::Lease(Simulation& simulation) : busy_(simulation.busy_) {
  if (busy_.exchange(true)) fail("this simulation is being stepped by another thread");
}

bool Simulation::finished() const { return time_ >= duration() * (1.0 - 1e-12); }

const loop::EnergyBalance& Simulation::energy() const {
  if (!balance_) fail("energies are computed only on request: Simulation(scene, energy=True)");
  return balance_->balance();
}

ExternalForces& Simulation::external_forces(std::size_t body) {
  if (external_forces_.empty())
    fail("external forces are added only on request: Simulation(scene, external_forces=True)");
  return *external_forces_.at(body);
}

void Simulation::changed(dynamics::ReinitReason reason) {
  if (world_->stepper) world_->stepper->reinit(reason);
}

bool Simulation::next() {
  if (broken_) fail("a step of this simulation ended by an exception; create a new simulation");
  broken_ = true;  // stays true if next() throws
  const bool advanced = run_->next();
  broken_ = false;
  if (advanced) {
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
