// Friction's tangent is unsymmetric: linear solvers used for it in each family of implicit methods.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <tuple>

#include "core/counters.h"
#include "loop/small_scenes.h"
#include "loop/summary.h"
#include "palpate/integrate/integrators.h"
#include "palpate/loop/run.h"
#include "palpate/loop/world.h"
#include "summary_rows.h"

using namespace palpate;

namespace {

/// A block that slides over the floor, pressed by its weight; inertia shears its upper side.
scene::Description sliding(const std::string& integrator, double friction, double stiffness_pa_m,
                           double depth_m = 5e-4) {
  scene::Description d = small_scenes::held_block();
  d.bodies[0].attachments.clear();
  d.bodies[0].velocity_m_s = Vec3(0.5, 0.2, 0.0);
  d.bodies[0].position_m.z() -= depth_m;
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  d.duration_s = 0.02;
  ContactSpec contact;
  contact.first = "block";
  contact.stiffness_pa_m = stiffness_pa_m;
  contact.friction = friction;
  contact.friction_regularisation_m_s = 0.05;
  contact.friction_anchors = false;
  small_scenes::add_floor(d, contact);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.01;
  d.integrator.name = integrator;
  d.integrator.rtol = 1e-6;  // some hundred steps, so that a single Newton iteration is not significant
  d.integrator.step_s = 1e-3;
  return d;
}

struct Ran {
  VecX q;
  dynamics::StepperCounters counters;
  long lu = 0, left_to_lu = 0;  ///< number of LU solvers; matrices passed on to LU by fallback
};
Ran run(scene::Description d, const std::string& solver) {
  d.integrator.linear_solver = solver;
  counters::reset();
  const auto world = loop::assemble(d);
  EXPECT_FALSE(world->system.symmetric());
  const loop::RunResult result = loop::run(*world, {});
  EXPECT_TRUE(result.status.ok()) << d.integrator.name << ", " << solver << ": " << result.status.message;
  return {world->state.q(), result.counters, counters::counter("integrate.solver.umfpack"),
          counters::counter("integrate.matrices_left_to_lu")};
}

/// Newton iterations per attempted step.
double newton_a_step(const Ran& ran) {
  return static_cast<double>(ran.counters.newton_iterations) /
         static_cast<double>(ran.counters.steps + ran.counters.rejected);
}

double moved(const scene::Description& d, const Ran& ran) {
  return (ran.q - loop::assemble(d)->state.q()).norm();
}

// The iteration's error stays below the accuracy of Newton's method: it needs as many Newton iterations as LU
// factorisations do, and gives the same motion. Error control turns rounding into different step lengths, as
// does a change of the friction coefficient by 1e-13: those methods are compared within their tolerance, and
// by Newton iterations per step with both runs by LU. One dynamic method of each family.
TEST(FrictionSolver, NoFamilyOfMethodsNeedsLu) {
  std::set<std::string> families;
  for (const auto& entry : integrate::stepper_registry()) {
    if (!entry.traits.implicit || entry.traits.stability == dynamics::Stability::kStatic) continue;
    if (!families.insert(entry.traits.family).second) continue;
    scene::Description d = sliding(entry.name, 0.3, 1e6);
    d.contacts[0].friction_tangent = FrictionTangent::kFull;
    const Ran krylov = run(d, "cholmod"), lu = run(d, "umfpack");
    EXPECT_EQ(krylov.lu, 0) << entry.name;
    EXPECT_EQ(krylov.left_to_lu, 0) << entry.name;
    EXPECT_EQ(krylov.counters.unconverged, 0) << entry.name;
    EXPECT_GE(lu.lu, 1) << entry.name;
    // contact is on the fast side, which is explicit: the slow side's matrix is symmetric
    EXPECT_EQ(krylov.counters.solver.iterations > krylov.counters.solver.solves,
              entry.traits.family != "multi-rate")
        << entry.name;
    const double apart = (krylov.q - lu.q).norm();
    if (entry.traits.control == dynamics::StepControl::kFixed) {
      EXPECT_LT(apart, 1e-7 * moved(d, lu)) << entry.name;
      EXPECT_EQ(krylov.counters.newton_iterations, lu.counters.newton_iterations) << entry.name;
    } else {
      EXPECT_LT(apart, d.integrator.rtol * moved(d, lu)) << entry.name;
      scene::Description rounded = d;
      rounded.contacts[0].friction *= 1.0 + 1e-13;
      const double by_lu = newton_a_step(lu), by_rounded = newton_a_step(run(rounded, "umfpack"));
      EXPECT_GE(newton_a_step(krylov), 0.9 * std::min(by_lu, by_rounded)) << entry.name;
      EXPECT_LE(newton_a_step(krylov), 1.1 * std::max(by_lu, by_rounded)) << entry.name;
    }
  }
  EXPECT_GE(families.size(), 6u);
}

// Contact stiffer than 4/mu^2 times the nodes behind it: the symmetric part is indefinite, and LU is used.
TEST(FrictionSolver, LeavesAnIndefiniteSymmetricPartToLuAndSaysSo) {
  for (const char* integrator : {"cvode-bdf", "ida", "backward-euler"}) {
    scene::Description d = sliding(integrator, 1.2, 3e9, 1e-5);
    d.integrator.rtol = 1e-2;  // steps long enough for the mass not to dominate the nodes' stiffness
    const Ran krylov = run(d, "cholmod"), lu = run(d, "umfpack");
    EXPECT_EQ(krylov.lu, 1) << integrator;
    EXPECT_GT(krylov.left_to_lu, 0) << integrator;
    EXPECT_GE(krylov.counters.indefinite, krylov.left_to_lu) << integrator;
    EXPECT_EQ(lu.left_to_lu, 0) << integrator << ": it was named";
    EXPECT_LT((krylov.q - lu.q).norm(), d.integrator.rtol * moved(d, lu)) << integrator;
  }
}

TEST(FrictionSolver, SummaryCountsTheMatricesLeftToLu) {
  for (const auto& [friction, stiffness, some] : {std::tuple{0.3, 1e6, false}, {1.2, 3e8, true}}) {
    scene::Description d = sliding("backward-euler", friction, stiffness);
    d.integrator.linear_solver = "cholmod";
    counters::reset();
    const auto world = loop::assemble(d);
    const loop::RunResult result = loop::run(*world, {});
    store::Summary summary = loop::summarise(*world, result, 0.0);
    long long named = 0;
    for (const store::SummaryFields& row : summary.list("constructions"))
      if (std::get<std::string>(*summary_rows::find(row, "name")) == "integrate.matrices_left_to_lu")
        named = summary_rows::count(row, "count");
    EXPECT_EQ(named > 0, some);
  }
}

}  // namespace
