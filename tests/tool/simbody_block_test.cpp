#include "tool/simbody_block.h"

#include <gtest/gtest.h>

#include <random>

#include "core/counters.h"
#include "palpate/dynamics/system.h"
#include "tool_fixtures.h"

using namespace palpate;
using namespace palpate::tool;
using namespace palpate::tool::testing;

namespace {

const Vec3 kGravity(1.0, -2.0, -9.81);

ToolSpec heavy_tool() {
  ToolSpec spec = spec_for("linearly-implicit-euler");
  spec.gravity = true;
  return spec;
}

/// A State with random values and three nodes before the tool, so that its offset in q and u is not 0.
struct RandomState {
  dynamics::State state{32, 32};
  int id = -1;
  RandomState(const ToolSpec& spec, std::mt19937& rng) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    dynamics::BlockSpec nodes;
    nodes.name = "nodes";
    nodes.q_size = nodes.u_size = 9;
    const auto random = [&](int n) { return VecX(VecX::NullaryExpr(n, [&] { return uniform(rng); })); };
    state.insert(nodes, random(9), random(9));
    id = state.insert(tool_block(spec), random(7), 20 * random(6));  // unnormalised, as in trial steps
  }
};

struct Both {
  dynamics::System simbody, closed;
  Both(const ToolSpec& spec, int id) {
    const SimbodyTerms terms = make_simbody_terms(id, spec, kGravity);
    simbody.add(terms.inertia);
    simbody.add(terms.force);
    closed.add(make_rigid_inertia(id, spec.mass_kg, spec.inertia_kg_m2));
    closed.add(make_gyroscopic(id, spec.inertia_kg_m2, true));
    closed.add(make_rigid_weight(id, spec.mass_kg, spec.gravity ? kGravity : Vec3(Vec3::Zero())));
  }
};

}  // namespace

// Two derivations of one rigid body: Simbody's recursive dynamics, and the Newton-Euler equations.
TEST(SimbodyBlock, has_the_mass_force_and_energy_of_the_closed_form) {
  std::mt19937 rng(11);
  int checked = 0;
  for (const bool gravity : {true, false})
    for (int run = 0; run < 20; ++run, ++checked) {
      ToolSpec spec = heavy_tool();
      spec.gravity = gravity;
      const RandomState body(spec, rng);
      Both terms(spec, body.id);
      const auto view = body.state.view();
      VecX f, expected;
      terms.simbody.force(view, f);
      terms.closed.force(view, expected);
      ASSERT_EQ(f.size(), 15);
      EXPECT_LT((f - expected).norm(), 1e-13 * std::max(expected.norm(), 1e-3)) << "gravity " << gravity;
      const VecX x = VecX::LinSpaced(15, -1.0, 2.0);
      terms.simbody.apply_mass(view, x, f);
      terms.closed.apply_mass(view, x, expected);
      EXPECT_LT((f - expected).norm(), 1e-13 * expected.norm());
      EXPECT_NEAR(terms.simbody.kinetic_energy(view) / terms.closed.kinetic_energy(view), 1.0, 1e-13);
      EXPECT_NEAR(terms.simbody.potential_energy(view), terms.closed.potential_energy(view), 1e-13);
    }
  EXPECT_EQ(checked, 40);
}

TEST(SimbodyBlock, assembled_mass_and_tangent_are_the_closed_forms) {
  std::mt19937 rng(12);
  const ToolSpec spec = heavy_tool();
  const RandomState body(spec, rng);
  Both terms(spec, body.id);
  dynamics::BorderedMatrix A, B;
  terms.simbody.step_matrix(body.state.view(), 1.0, 0.0, 0.0, A);
  terms.closed.step_matrix(body.state.view(), 1.0, 0.0, 0.0, B);
  EXPECT_LT((A.corner - B.corner).norm(), 1e-13 * B.corner.norm());
  EXPECT_EQ(A.right.norm(), 0.0);
  terms.simbody.step_matrix(body.state.view(), 0.0, 0.3, 0.05, A);
  terms.closed.step_matrix(body.state.view(), 0.0, 0.3, 0.05, B);
  EXPECT_LT((A.corner - B.corner).norm(), 1e-13 * B.corner.norm());
  EXPECT_FALSE(terms.simbody.symmetric()) << "a gyroscopic tangent is not";
}

// f(x + h d, u + h e) - f + h (K d + D e) decreases as h^2: the tangent is that of Simbody's force, as well
// as of the closed form.
TEST(SimbodyBlock, tangent_is_the_derivative_of_simbodys_force) {
  std::mt19937 rng(13);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const ToolSpec spec = heavy_tool();
  RandomState body(spec, rng);
  const SimbodyTerms terms = make_simbody_terms(body.id, spec, kGravity);
  const Quat r0 =
      Quat(body.state.q()[9], body.state.q()[10], body.state.q()[11], body.state.q()[12]).normalized();
  const VecX u0 = body.state.u();
  const Vec6 d = Vec6::NullaryExpr([&] { return uniform(rng); }),
             e = Vec6::NullaryExpr([&] { return 20 * uniform(rng); });
  const auto at = [&](double h) {
    const Quat r = quaternion_of(h * d.head<3>()) * r0;
    body.state.q().segment<4>(9) << r.w(), r.vec();
    body.state.u() = u0;
    body.state.u().tail<6>() += h * e;
    VecX f = VecX::Zero(15);
    terms.force->add_force(body.state.view(), f);
    return f;
  };
  const VecX f0 = at(0.0);
  VecX dx = VecX::Zero(15), du = VecX::Zero(15), linear = VecX::Zero(15);
  dx.tail<6>() = d;
  du.tail<6>() = e;
  terms.force->apply_tangent(body.state.view(), 1.0, 0.0, dx, linear);
  terms.force->apply_tangent(body.state.view(), 0.0, 1.0, du, linear);
  std::vector<double> hs, errors;
  for (double h = 0.02; h > 5e-4; h /= 2) {
    hs.push_back(h);
    errors.push_back((at(h) - f0 + h * linear).norm());
  }
  EXPECT_NEAR(slope(hs, errors), 2.0, 0.1);
}

TEST(SimbodyBlock, makes_one_simbody_system_and_refuses_what_is_no_tool) {
  const long before = counters::counter("tool.simbody_system");
  const SimbodyTerms terms = make_simbody_terms(3, heavy_tool(), kGravity);
  EXPECT_EQ(counters::counter("tool.simbody_system"), before + 1);
  ToolSpec bad = heavy_tool();
  bad.mass_kg = -1.0;
  EXPECT_THROW(make_simbody_terms(3, bad, kGravity), Error);
}

TEST(SimbodyBlock, scales_are_the_couplings_own) {
  ToolSpec spec = heavy_tool();
  spec.radius_m = 0.02;
  const dynamics::BlockSpec block = tool_block(spec);
  EXPECT_DOUBLE_EQ(block.q_scale, 0.02);
  EXPECT_NEAR(block.u_scale, 0.02 * std::sqrt(300.0 / 0.1), 1e-12);
  spec.coupling.stiffness_n_m = 0.0;
  EXPECT_DOUBLE_EQ(tool_block(spec).u_scale, 0.02) << "nothing pulls: one radius a second";
}

TEST(SimbodyBlock, the_hand_feels_what_the_simbody_tool_lets_it_feel) {
  const ToolSpec spec = heavy_tool();
  Tool tool(spec, Vec3::Zero());
  const Pose pose{quaternion_of(Vec3(0.1, -0.4, 0.2)), Vec3(0.01, 0.02, 0.03)},
      handle{quaternion_of(Vec3(0.3, 0.1, 0)), Vec3(0, 0.01, 0)};
  const Twist twist{Vec3(1, 2, 3), Vec3(0.1, 0.2, 0.3)}, handle_twist{Vec3(0, 1, 0), Vec3(0, 0, 0.5)};
  tool.set_state(0.0, pose, twist);
  const Wrench expected = tool.wrench_on_hand(handle, handle_twist),
               got = coupling_on_hand(spec, {tool.pose(), twist}, {handle, handle_twist});
  EXPECT_LT((got.force - expected.force).norm(), 1e-14);
  EXPECT_LT((got.moment - expected.moment).norm(), 1e-14);
}
