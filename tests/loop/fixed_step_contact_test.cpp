// A contact that closes within a fixed step: Newton's iteration has no shorter step to fall back on.
#include <gtest/gtest.h>

#include "loop/small_scenes.h"
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
