#include <gtest/gtest.h>

#include "coupling.h"
#include "tool_fixtures.h"

using namespace palpate;
using namespace palpate::tool;
using namespace palpate::tool::testing;

namespace {

const Pose kStart{quaternion_of(Vec3(0.9, -1.1, 0.7)), Vec3(0.01, -0.02, 0.015)};
const Twist kThrown{Vec3(3, -5, 2), Vec3(0.1, 0.0, -0.2)};

double stored(const ToolSpec& spec, const Tool& tool) {
  return tool.kinetic_energy() + coupling_energy(coupling_gains(spec), tool.pose(), {});
}

}  // namespace

// Translation and a large rotation about no principal axis, with gyroscopic terms: without damping, kinetic +
// coupling energy is conserved.
TEST(ToolEnergy, undamped_coupling_keeps_it) {
  for (const std::string name : {"simbody-rkmerson", "simbody-cpodes"}) {
    ToolSpec spec = spec_for(name);
    spec.coupling.damping_n_s_m = spec.coupling.rotational_damping_n_m_s_rad = 0.0;
    Tool tool(spec, Vec3::Zero());
    tool.set_state(0.0, kStart, kThrown);
    const double before = stored(spec, tool);
    double worst = 0.0;
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(tool.advance(1e-3, held({}), {}).ok());
      worst = std::max(worst, std::abs(stored(spec, tool) / before - 1.0));
    }
    EXPECT_LT(worst, 1e-6) << name;
  }
}

// The loss of energy is the damper's: E(0) - E(T) = int (b |v|^2 + b_r |w|^2) dt, by Simpson's rule over the
// ticks.
TEST(ToolEnergy, the_damper_accounts_for_the_loss) {
  ToolSpec spec = spec_for("simbody-rkmerson");
  Tool tool(spec, Vec3::Zero());
  tool.set_state(0.0, kStart, kThrown);
  const double before = stored(spec, tool);
  const auto power = [&] { return coupling_dissipation(coupling_gains(spec), tool.twist(), {}); };
  const int n = 400;
  const double h = 1e-4;
  double lost = power();
  for (int i = 1; i <= n; ++i) {
    ASSERT_TRUE(tool.advance(h, held({}), {}).ok());
    lost += (i == n ? 1 : i % 2 ? 4 : 2) * power();
  }
  lost *= h / 3;
  EXPECT_GT(lost, 0.2 * before);
  EXPECT_NEAR((before - stored(spec, tool)) / lost, 1.0, 1e-6);
}

TEST(ToolEnergy, a_free_top_keeps_energy_and_angular_momentum) {
  ToolSpec spec = spec_for("simbody-rkmerson");
  spec.coupling.rotational_stiffness_n_m_rad = spec.coupling.rotational_damping_n_m_s_rad = 0.0;
  Tool tool(spec, Vec3::Zero());
  tool.set_state(0.0, kStart, {Vec3(2, 30, 1), Vec3::Zero()});
  const auto momentum = [&] { return Vec3(tool.mass_matrix().topLeftCorner<3, 3>() * tool.twist().angular); };
  const double energy = tool.kinetic_energy() - 0.5 * spec.mass_kg * tool.twist().linear.squaredNorm();
  const Vec3 L = momentum();
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(tool.advance(1e-3, held(tool.pose()), {}).ok());
  EXPECT_LT((momentum() - L).norm() / L.norm(), 1e-7);
  EXPECT_NEAR((tool.kinetic_energy() - 0.5 * spec.mass_kg * tool.twist().linear.squaredNorm()) / energy, 1.0,
              1e-7);
}

TEST(ToolEnergy, weight_only_where_asked) {
  for (const auto& info : tool_integrators())
    for (bool on : {false, true}) {
      ToolSpec spec = spec_for(info.name);
      spec.gravity = on;
      spec.coupling.stiffness_n_m = spec.coupling.damping_n_s_m = 0.0;
      Tool tool(spec, Vec3(0, 0, -9.81));
      for (int i = 0; i < 10; ++i) ASSERT_TRUE(tool.advance(1e-3, held({}), {}).ok());
      // v = g t is exact in all of them
      EXPECT_NEAR(tool.twist().linear.z(), on ? -0.0981 : 0.0, 1e-12) << info.name;
    }
}
