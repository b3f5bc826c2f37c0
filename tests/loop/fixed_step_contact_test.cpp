// A contact that closes within a fixed step: Newton's iteration has no shorter step to fall back on.
#include <gtest/gtest.h>

#include <tuple>

#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"
#include "palpate/loop/run.h"
#include "palpate/loop/world.h"

using namespace palpate;

namespace {

/// A cube that just touches an incline below the angle of friction; k = 1e7 Pa/m under a quarter of its face
/// and an eighth of its mass make w H = 6.
scene::Description on_an_incline(const std::string& integrator) {
  constexpr double kSlope = 0.2;
  scene::Description d;
  d.name = "incline";
  d.duration_s = 0.5;
  d.gravity_m_s2 = 9.81 / std::sqrt(1.0 + kSlope * kSlope) * Vec3(kSlope, 0, -1);
  SoftBodySpec cube;
  cube.name = "cube";
  cube.mesh.generator = "box";
  cube.mesh.size_m = Vec3::Constant(0.05);
  cube.mesh.element_size_m = 0.05;
  cube.position_m = Vec3(0, 0, 0.025);
  cube.youngs_modulus_pa = 1e5;
  cube.stiffness_damping_s = 1e-3;
  d.bodies.push_back(cube);
  ContactSpec contact;
  contact.first = "cube";
  contact.stiffness_pa_m = 1e7;
  contact.damping_pa_s_m = 1e5;
  contact.friction = 0.5;
  contact.friction_regularisation_m_s = 0.05;
  small_scenes::add_floor(d, contact);
  d.exchange.contact_refresh_s = 0.01;
  d.integrator.name = integrator;
  d.integrator.fixed_step = true;
  d.integrator.step_s = 0.01;
  return d;
}

/// Cash's two tables have c = -0.7: that stage stands before the step, where the damper of the contact jumps,
/// and its equation need have no solution.  They are given a contact without the jump.
bool has_a_stage_behind_its_start(const std::string& name) { return name.starts_with("ark-dirk-cash"); }

}  // namespace

// It settles and creeps, v = v_r tan(a)/mu = 0.02 m/s, whatever the table.
TEST(FixedStepContact, EveryImplicitTableOfArkodeFindsIt) {
  int tried = 0;
  for (const auto& entry : integrate::stepper_registry()) {
    if (!entry.name.starts_with("ark-dirk-") && !entry.name.starts_with("ark-imex-")) continue;
    scene::Description d = on_an_incline(entry.name);
    if (has_a_stage_behind_its_start(entry.name)) d.contacts[0].onset_width_m = 2e-5;
    const auto world = loop::assemble(d);
    const loop::RunResult result = loop::run(*world, {});
    ASSERT_TRUE(result.status.ok()) << entry.name << ": " << result.status.message;
    const Points v = Eigen::Map<const Points>(world->state.u().data(), 3, world->state.u().size() / 3);
    EXPECT_NEAR(v.row(0).mean(), 0.02, 2e-4) << entry.name;
    EXPECT_LT(std::abs(v.row(2).mean()), 2e-4) << entry.name;
    EXPECT_LT(result.counters.tangent_evaluations, 3 * result.counters.steps)
        << entry.name << ": one tangent does but where contact closes";
    ++tried;
  }
  EXPECT_EQ(tried, 28);
}

// A cube that slides on a level floor comes to rest; a step of one linear solve, h mu g = 0.05 m/s of
// velocity each, does not carry it beyond.  With the tangent of friction, which is zero along the sliding, it
// turns round at |v| = h mu g/2, and friction takes m (h mu g)^2/2 a step that nobody gave (sample_math.cpp).
// A soft cube would turn round as well: sheared by what slows it down, it springs back at about
// mu g L sqrt(rho/G)/2, here 2e-4 m/s; and so would one that is tilted on soft springs.
TEST(FixedStepContact, SlidingEndsAtRestWhereAStepIsOneSolve) {
  constexpr double kSpeed = 0.31, kLost = 0.01 * 0.5 * 9.81;
  for (const std::string tangent : {"auto", "secant", "symmetric"}) {
    scene::Description d = on_an_incline("linearly-implicit-euler");
    d.gravity_m_s2 = Vec3(0, 0, -9.81);
    d.bodies[0].velocity_m_s = Vec3(kSpeed, 0, 0);
    d.bodies[0].youngs_modulus_pa = 1e9;
    d.contacts[0].stiffness_pa_m = 1e9;
    d.contacts[0].friction_regularisation_m_s = 1e-3;
    d.contacts[0].friction_tangent = tangent;
    double least = kSpeed, last = kSpeed;
    for (int k = 1; k <= 30; ++k) {
      const auto world = loop::assemble(d);
      loop::RunOptions options;
      options.duration_s = 0.01 * k;
      ASSERT_TRUE(loop::run(*world, options).status.ok());
      last = Eigen::Map<const Points>(world->state.u().data(), 3, world->state.u().size() / 3).row(0).mean();
      least = std::min(least, last);
    }
    if (tangent == "symmetric") {
      EXPECT_LT(least, -0.2 * kLost) << "turns round";
    } else {
      EXPECT_GT(least, -0.01 * kLost) << tangent;
      EXPECT_LT(std::abs(last), 1e-3) << tangent << ": below v_r";
    }
  }
}

// Where a step is one linear solve, the step matrix leaves out how friction follows the pressure, unless the
// scene asks for it: then it is unsymmetric, as for all other methods.  Either way the cube creeps as it
// should, and what was left out is told.
TEST(FixedStepContact, FrictionNeedsNoLuWhereAStepIsOneSolve) {
  for (const auto& [integrator, tangent, symmetric] :
       {std::tuple{"linearly-implicit-euler", "auto", true},
        std::tuple{"linearly-implicit-euler", "full", false}, std::tuple{"backward-euler", "auto", false},
        std::tuple{"backward-euler", "symmetric", true}}) {
    scene::Description d = on_an_incline(integrator);
    d.contacts[0].friction_tangent = tangent;
    const auto world = loop::assemble(d);
    EXPECT_EQ(world->system.symmetric(), symmetric) << integrator << ", " << tangent;
    const loop::RunResult result = loop::run(*world, {});
    ASSERT_TRUE(result.status.ok()) << integrator << ", " << tangent << ": " << result.status.message;
    const Points v = Eigen::Map<const Points>(world->state.u().data(), 3, world->state.u().size() / 3);
    EXPECT_NEAR(v.row(0).mean(), 0.02, 2e-4) << integrator << ", " << tangent;
    const double friction = world->contact->largest_lagged_friction(),
                 left_out = world->contact->largest_friction_lag();
    EXPECT_EQ(friction > 0.0, symmetric) << integrator << ", " << tangent;
    EXPECT_EQ(left_out > 0.0, symmetric) << integrator << ", " << tangent;
  }
  scene::Description d = on_an_incline("backward-euler");
  d.contacts[0].friction_tangent = "symetric";
  try {
    loop::assemble(d);
    FAIL() << "taken";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("unknown friction_tangent \"symetric\" (did you mean"),
              std::string::npos)
        << error.what();
  }
}
