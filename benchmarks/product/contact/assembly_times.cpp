#include "product/contact/assembly_times.h"

#include "core/clock.h"
#include "palpate/core/error.h"
#include "palpate/fem/soft_body.h"
#include "palpate/linear/solvers.h"

namespace palpate::bench {
namespace {

constexpr double kStiffness = 1e-4, kRate = 1e-2;  // h^2 and h of a step of 10 ms.

}  // namespace

AssemblyTimes::AssemblyTimes(loop::World& world)
    : world_(world), solver_(linear::make_linear_solver("pcg-single", {.linear_rtol = 1e-3})) {
  dynamics::PatternBuilder pattern(world.state.layout());
  world.bodies.front().term->add_pattern(pattern);
  pattern_ = pattern.build();
  elements_ = dynamic_cast<dynamics::MixedPrecisionSolver&>(*solver_).step_matrix(pattern_);
  PALPATE_CHECK(elements_, "pcg-single has no room for a step matrix");
  elements_->diagonal = VecX::Ones(world.state.layout().u_size);
}

double AssemblyTimes::elements_ms() {
  const dynamics::StateView state = world_.state.view();
  shift_ = kRate * state.u;
  force_.setZero(shift_.size());
  const double start = wall_seconds();
  world_.bodies.front().term->add_step(state, shift_, kStiffness, kRate, force_, *elements_);
  return 1e3 * (wall_seconds() - start);
}

double AssemblyTimes::contact_ms() {
  contact::ContactForce& contact = *world_.contact;
  if (!contact.is_point_stiffness()) return 0.0;
  const dynamics::StateView state = world_.state.view();
  shift_ = kRate * state.u;
  force_.setZero(shift_.size());
  points_.clear();
  border_.reset(state.layout->node_count(), state.layout->border_size());
  const double start = wall_seconds();
  contact.add_step(state, shift_, kStiffness, kRate, force_, points_, border_);
  return 1e3 * (wall_seconds() - start);
}

}  // namespace palpate::bench
