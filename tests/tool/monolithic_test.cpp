#include <gtest/gtest.h>

#include "palpate/dynamics/system.h"
#include "palpate/integrate/integrators.h"
#include "tool/rigid_block.h"
#include "tool_fixtures.h"

using namespace palpate;
using namespace palpate::tool;
using namespace palpate::tool::testing;

namespace {

/// A tool as a block of a System, advanced by an integrator of soft bodies.
struct Monolith {
  dynamics::State state{16, 16};
  dynamics::System system;
  int id = -1;
  std::unique_ptr<dynamics::Stepper> stepper;

  Monolith(const ToolSpec& spec, const Pose& pose, const Twist& twist) {
    VecX q(7), u(6);
    q << pose.rotation.w(), pose.rotation.vec(), pose.translation;
    u << twist.angular, twist.linear;
    id = state.insert(rigid_block("tool", 0.01, 0.1), q, u);
    system.add(make_rigid_inertia(id, spec.mass_kg, spec.inertia_kg_m2));
  }
  void start(const std::string& integrator, double rtol) {
    system.prepare(state.view());
    IntegratorSpec spec;
    spec.name = integrator;
    spec.rtol = rtol;
    spec.step_s = 1e-3;
    spec.linear_solver = system.symmetric() ? "cholmod" : "umfpack";
    stepper = integrate::make_stepper(system, state, spec);
  }
  Pose pose() const {
    const auto q = state.q();
    return {Quat(q[0], q[1], q[2], q[3]), q.tail<3>()};
  }
};

HandlePath still(const Pose& pose) {
  return [pose](double) { return HandleState{pose, {}}; };
}

}  // namespace

TEST(Monolithic, cvode_follows_the_damped_oscillator) {
  const ToolSpec spec = spec_for("linearly-implicit-euler");
  for (bool symmetric : {false, true}) {
    const Pose handle{quaternion_of(Vec3(0, 2.5, 0)), Vec3(0, 0.01, 0)};
    Monolith m(spec, {}, {});
    m.system.add(make_gyroscopic(m.id, spec.inertia_kg_m2, !symmetric));
    m.system.add(make_coupling_term(m.id, spec, still(handle), symmetric));
    m.start("cvode-bdf", 1e-9);
    const Oscillator rotational{spec.inertia_kg_m2.y(), spec.coupling.rotational_damping_n_m_s_rad,
                                spec.coupling.rotational_stiffness_n_m_rad};
    const Oscillator shifting{spec.mass_kg, spec.coupling.damping_n_s_m, spec.coupling.stiffness_n_m};
    for (int i = 1; i <= 10; ++i) {
      const auto result = m.stepper->advance_to(0.01 * i);
      ASSERT_TRUE(result.ok()) << result.message;
      const Vec6 d = pose_difference(handle, m.pose());
      EXPECT_NEAR(d[1], rotational.at_time(-2.5, 0.01 * i), 1e-6 * 2.5) << "symmetric " << symmetric;
      EXPECT_NEAR(d[4], shifting.at_time(-0.01, 0.01 * i), 1e-6 * 0.01);
    }
  }
}

TEST(Monolithic, a_free_top_keeps_energy_and_angular_momentum) {
  const ToolSpec spec = spec_for("linearly-implicit-euler");
  Monolith m(spec, {quaternion_of(Vec3(0.3, 0.2, 0.1)), Vec3::Zero()}, {Vec3(2, 30, 1), Vec3::Zero()});
  m.system.add(make_gyroscopic(m.id, spec.inertia_kg_m2, true));
  m.start("cvode-bdf", 1e-10);
  VecX before, after;
  m.system.apply_mass(m.state.view(), VecX(m.state.u()), before);
  const double energy = m.system.kinetic_energy(m.state.view());
  ASSERT_TRUE(m.stepper->advance_to(0.5).ok());
  m.system.apply_mass(m.state.view(), VecX(m.state.u()), after);
  EXPECT_LT((after - before).norm() / before.norm(), 1e-6);
  EXPECT_NEAR(m.system.kinetic_energy(m.state.view()) / energy, 1.0, 1e-6);
}

// Two independent implementations: Simbody's Merson, and CVODE on the block, with a large rotation about no
// principal axis and a moving handle.
TEST(Monolithic, agrees_with_the_simbody_tool) {
  const ToolSpec spec = spec_for("simbody-rkmerson");
  const Vec3 axis = Vec3(1, 2, -1).normalized();
  const HandlePath path = [axis](double t) {
    return HandleState{
        {quaternion_of((1.5 + 0.8 * std::sin(9 * t)) * axis), Vec3(0.02 * std::sin(11 * t), 0, 0.01 * t)},
        {7.2 * std::cos(9 * t) * axis, Vec3(0.22 * std::cos(11 * t), 0, 0.01)}};
  };
  const Pose start{quaternion_of(Vec3(0.4, -0.6, 0.5)), Vec3(0.01, 0.02, 0)};
  Tool tool(spec, Vec3::Zero());
  tool.set_state(0.0, start, {Vec3(3, -4, 5), Vec3::Zero()});
  for (int i = 0; i < 200; ++i) {
    const HandleState a = path(5e-4 * i), b = path(5e-4 * (i + 1));
    ASSERT_TRUE(tool.advance(5e-4, {a.pose, b.pose, a.twist, b.twist}, {}).ok());
  }
  Monolith m(spec, start, {Vec3(3, -4, 5), Vec3::Zero()});
  m.system.add(make_gyroscopic(m.id, spec.inertia_kg_m2, true));
  m.system.add(make_coupling_term(m.id, spec, path));
  m.start("cvode-bdf", 1e-9);
  const auto result = m.stepper->advance_to(0.1);
  ASSERT_TRUE(result.ok()) << result.message;
  EXPECT_LT(pose_difference(m.pose(), tool.pose()).norm(), 1e-6);
}
