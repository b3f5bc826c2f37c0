#include <gtest/gtest.h>

#include "core/counters.h"
#include "tool_fixtures.h"

using namespace palpate;
using namespace palpate::tool;
using namespace palpate::tool::testing;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string message(const ToolSpec& spec) {
  try {
    Tool tool(spec, Vec3(0, 0, -9.81));
  } catch (const Error& e) { return e.what(); }
  return "";
}

template <class Change>
std::string message_with(Change change) {
  ToolSpec spec = spec_for("linearly-implicit-euler");
  change(spec);
  return message(spec);
}

}  // namespace

TEST(Tool, starts_where_the_spec_says) {
  ToolSpec spec = spec_for("linearly-implicit-euler");
  spec.position_m = Vec3(1, 2, 3);
  spec.rotation_vector_rad = Vec3(0, 0, 0.5);
  const Tool tool(spec, Vec3::Zero());
  EXPECT_EQ(tool.time(), 0.0);
  EXPECT_EQ(tool.pose().translation, Vec3(1, 2, 3));
  EXPECT_NEAR(rotation_vector(tool.pose().rotation).z(), 0.5, 1e-15);
  EXPECT_EQ(tool.twist().linear.norm() + tool.twist().angular.norm(), 0.0);
}

TEST(Tool, an_inertia_left_out_is_the_solid_spheres) {
  ToolSpec spec;
  spec.mass_kg = 0.5;
  spec.radius_m = 0.02;
  const Mat6 M = Tool(spec, Vec3::Zero()).mass_matrix();
  Vec6 diagonal;
  diagonal << Vec3::Constant(0.4 * 0.5 * 4e-4), Vec3::Constant(0.5);
  EXPECT_LT((M - Mat6(diagonal.asDiagonal())).norm(), 1e-18);
}

TEST(Tool, mass_matrix_and_energy_rotate_with_the_body) {
  Tool tool(spec_for("linearly-implicit-euler"), Vec3::Zero());
  // A rotation by pi/2 about z swaps x and y moments.
  tool.set_state(1.0, {quaternion_of(Vec3(0, 0, M_PI / 2)), Vec3::Zero()}, {Vec3(2, 0, 0), Vec3(0, 3, 0)});
  EXPECT_NEAR(tool.mass_matrix()(0, 0), 4e-5, 1e-18);
  EXPECT_NEAR(tool.mass_matrix()(1, 1), 3e-5, 1e-18);
  EXPECT_NEAR(tool.kinetic_energy(), 0.5 * 4e-5 * 4 + 0.5 * 0.1 * 9, 1e-15);
}

TEST(Tool, set_state_normalises_and_moves_the_clock) {
  for (const auto& info : tool_integrators()) {
    Tool tool(spec_for(info.name), Vec3::Zero());
    tool.set_state(2.5, {Quat(2, 0, 0, 2), Vec3(0.1, 0, 0)}, {});
    EXPECT_NEAR(tool.pose().rotation.norm(), 1.0, 1e-15);
    ASSERT_TRUE(tool.advance(1e-3, held({}), {}).ok());
    EXPECT_DOUBLE_EQ(tool.time(), 2.501) << info.name;
    // A second change mid-way must reach an integrator with a history.
    tool.set_state(0.0, {Quat::Identity(), Vec3(0.2, 0, 0)}, {});
    ASSERT_TRUE(tool.advance(1e-3, held({}), {}).ok());
    EXPECT_NEAR(tool.pose().translation.x(), 0.2, 1e-3) << info.name;
    EXPECT_NEAR(tool.pose().rotation.norm(), 1.0, 1e-14) << info.name;
  }
  EXPECT_THROW(Tool(spec_for("simbody-rkmerson"), Vec3::Zero()).set_state(kNaN, {}, {}), InternalError);
}

TEST(Tool, equal_states_give_equal_ticks) {
  for (const auto& info : tool_integrators()) {
    const auto run = [&] {
      Tool tool(spec_for(info.name), Vec3::Zero());
      for (int i = 0; i < 20; ++i)
        EXPECT_TRUE(
            tool.advance(1e-3, held({quaternion_of(Vec3(0.1, 0.2, 0.3)), Vec3(0.01, 0, 0)}), wall(100)).ok());
      return tool.pose();
    };
    const Pose a = run(), b = run();
    EXPECT_EQ(a.translation, b.translation);
    EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
  }
}

TEST(Tool, what_is_not_finite_stays_out) {
  for (const auto& info : tool_integrators()) {
    Tool tool(spec_for(info.name), Vec3::Zero());
    ASSERT_TRUE(tool.advance(1e-3, held({Quat::Identity(), Vec3(0.01, 0, 0)}), {}).ok());
    const Pose before = tool.pose();
    auto bad_record = wall(100);
    bad_record.F0[2] = kNaN;
    for (const auto& result : {tool.advance(1e-3, held({Quat::Identity(), Vec3(kNaN, 0, 0)}), {}),
                               tool.advance(1e-3, held({}), bad_record)}) {
      EXPECT_EQ(result.status, dynamics::StepStatus::kNotFinite);
      EXPECT_NE(result.message.find("the handle state or the contact record is not finite"),
                std::string::npos);
    }
    EXPECT_EQ(tool.pose().translation, before.translation);
    EXPECT_DOUBLE_EQ(tool.time(), 1e-3);
    EXPECT_TRUE(tool.advance(1e-3, held({}), {}).ok()) << info.name << " goes on";
    // An extreme but finite record: bounded, an error status, or both; never a NaN in the state.
    auto huge = wall(100);
    huge.F0[5] = 1e305;
    for (int i = 0; i < 5; ++i) (void)tool.advance(1e-3, held({}), huge);
    EXPECT_TRUE(tool.pose().translation.allFinite() && tool.twist().linear.allFinite()) << info.name;
  }
}

TEST(Tool, hand_feels_the_opposite) {
  Tool tool(spec_for("linearly-implicit-euler"), Vec3::Zero());
  const Pose handle{quaternion_of(Vec3(0.2, 0, 0)), Vec3(0, 0.01, 0)};
  const Twist twist{Vec3(0, 0, 1), Vec3(0.5, 0, 0)};
  const Wrench tool_side = tool.coupling_wrench(handle, twist), hand = tool.wrench_on_hand(handle, twist);
  EXPECT_NEAR(tool_side.force.y(), 3.0, 1e-12);    // 300 N/m x 1 cm
  EXPECT_NEAR(tool_side.force.x(), 1.0, 1e-12);    // 2 N s/m x 0.5 m/s
  EXPECT_NEAR(tool_side.moment.x(), 0.06, 1e-14);  // 0.3 N m/rad x 0.2 rad
  EXPECT_NEAR(tool_side.moment.z(), 1e-3, 1e-16);
  EXPECT_EQ(hand.force, Vec3(-tool_side.force));
  EXPECT_EQ(hand.moment, Vec3(-tool_side.moment));
  Mat6 K, B;
  tool.coupling_tangent(handle, twist, K, B);
  EXPECT_NEAR(K(4, 4), 300.0, 1e-12);
  EXPECT_NEAR(K(0, 0), 0.3, 1e-14);  // the spring is linear about the axis of rotation
  EXPECT_NEAR(B(5, 5), 2.0, 1e-15);
}

TEST(Tool, counts_its_simbody_system) {
  const long before = counters::counter("tool.simbody_system");
  const Tool tool(spec_for("linearly-implicit-euler"), Vec3::Zero());
  EXPECT_EQ(counters::counter("tool.simbody_system"), before + 1);
}

TEST(Tool, bad_settings_are_refused) {
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(message_with([](ToolSpec& s) { s.integrator = "semi-implicit"; }),
                  "unknown tool integrator \"semi-implicit\""));
  EXPECT_TRUE(has(message_with([](ToolSpec& s) { s.mass_kg = 0; }), "tool: mass_kg = 0 must be positive"));
  EXPECT_TRUE(has(message_with([](ToolSpec& s) { s.inertia_kg_m2 = Vec3(1, 1, 2.1); }), "is impossible"));
  EXPECT_TRUE(
      has(message_with([](ToolSpec& s) { s.inertia_kg_m2 = Vec3(1, 0, 1); }), "three positive entries"));
  EXPECT_TRUE(has(message_with([](ToolSpec& s) { s.inertia_kg_m2.setZero(), s.radius_m = 0; }),
                  "radius_m = 0 must be positive"));
  EXPECT_TRUE(has(message_with([](ToolSpec& s) { s.coupling.stiffness_n_m = -1; }),
                  "tool.coupling: stiffness_n_m = -1 must not be negative"));
  EXPECT_TRUE(has(message_with([](ToolSpec& s) { s.coupling.rotational_damping_n_m_s_rad = kNaN; }),
                  "tool.coupling: rotational_damping_n_m_s_rad = nan"));
  EXPECT_TRUE(has(message_with([](ToolSpec& s) { s.tick_s = 0; }), "tick_s = 0 must lie in (0, 0.1)"));
  EXPECT_TRUE(has(message_with([](ToolSpec& s) { s.tick_s = 0.1; }), "tick_s = 0.1 must lie in (0, 0.1)"));
  EXPECT_TRUE(has(message_with([](ToolSpec& s) { s.position_m.x() = kNaN; }), "position_m"));
  Tool tool(spec_for("linearly-implicit-euler"), Vec3::Zero());
  EXPECT_THROW(tool.advance(0.0, held({}), {}), InternalError);
}
