#include <gtest/gtest.h>

#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "palpate/loop/world.h"

/// Two soft blocks in contact, from the scene's description to the end of a run.
namespace {

using namespace palpate;

constexpr double kWidth = 0.04, kLength = 0.02, kYoung = 1e4, kStiffness = 1e6;

scene::Description two_blocks(double gap) {
  scene::Description d = small_scenes::held_block();
  d.bodies[0].poissons_ratio = 0.0;
  d.bodies.push_back(d.bodies[0]);
  d.bodies[1].name = "upper";
  d.bodies[1].position_m.z() = 1.5 * kLength + gap;
  d.bodies[1].attachments[0].box_min_m.z() = 2 * kLength + gap - 1e-6;
  d.bodies[1].attachments[0].box_max_m.z() = 2 * kLength + gap + 1e-6;
  ContactSpec contact;
  contact.first = "block";
  contact.second = "upper";
  contact.method = "distance";
  contact.stiffness_pa_m = kStiffness;
  d.contacts.push_back(contact);
  d.gravity_m_s2 = Vec3::Zero();
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.01;
  return d;
}

Vec3 force_on_first(const loop::World& world) {
  Vec3 sum = Vec3::Zero();
  for (const auto& s : world.contact->samples()) {
    Vec3 apart = Vec3::Zero();
    for (int i = 0; i < s.a.count; ++i)
      apart += s.a.weight[static_cast<std::size_t>(i)] *
               world.state.view().position(s.a.node[static_cast<std::size_t>(i)]);
    for (int i = 0; i < s.b.count; ++i)
      apart -= s.b.weight[static_cast<std::size_t>(i)] *
               world.state.view().position(s.b.node[static_cast<std::size_t>(i)]);
    sum += kStiffness * std::max(0.0, -s.normal.dot(apart)) * s.area * s.normal;
  }
  return sum;
}

/// Mean height of the block's face whose rest height in the block's axes is `at_rest`; nodes on edges have
/// weight one half, those at corners a quarter [m].
double mean_height(const loop::World& world, std::size_t body, double at_rest) {
  const Points &rest = world.bodies[body].rest.nodes, now = world.positions(world.bodies[body]);
  double sum = 0.0, weights = 0.0;
  for (Eigen::Index i = 0; i < rest.cols(); ++i)
    if (std::abs(rest(2, i) - at_rest) < 1e-9) {
      const double weight = (std::abs(rest(0, i)) > 0.5 * kWidth - 1e-9 ? 0.5 : 1.0) *
                            (std::abs(rest(1, i)) > 0.5 * kWidth - 1e-9 ? 0.5 : 1.0);
      sum += weight * now(2, i);
      weights += weight;
    }
  return sum / weights;
}

// Outer faces held, pressed into each other by d: two bars of stiffness E A / L and the contact k A in series
// (nu = 0: no lateral strain, so that the uniform stress of a bar is the solution of the block), F = d / (2 L
// / (E A) + 1 / (k A)), which is one block of length 2 L compressed by the rest of d.
TEST(SoftPair, PressedTogetherTheyAreOneBlock) {
  constexpr double d = 1e-3, area = kWidth * kWidth,
                   exact = d / (2 * kLength / (kYoung * area) + 1 / (kStiffness * area));
  scene::Description description = two_blocks(-d);
  description.duration_s = 0.8;
  const auto world = loop::assemble(description);
  ASSERT_TRUE(loop::run(*world, {}).status.ok());
  const Vec3 force = force_on_first(*world);
  EXPECT_NEAR(-force.z() / exact, 1.0, 0.005);
  EXPECT_LT(force.head<2>().norm(), 2e-6 * exact);  // the rim, whose triangles are not symmetric
  // Symmetric about the middle plane: each face yields by F L / (E A).
  const double lower = mean_height(*world, 0, 0.5 * kLength), upper = mean_height(*world, 1, -0.5 * kLength);
  EXPECT_NEAR(kLength - lower, exact * kLength / (kYoung * area), 0.01 * d);
  EXPECT_NEAR(upper - (kLength - d), exact * kLength / (kYoung * area), 0.01 * d);
  EXPECT_NEAR(lower - upper, exact / (kStiffness * area), 0.01 * d);
}

struct Ran {
  VecX moved;
  dynamics::StepperCounters counters;
};
Ran run_by(const scene::Description& description, const std::string& solver, double duration_s = 0.1,
           double rtol = 1e-7) {
  scene::Description d = description;
  d.integrator = {.name = "linearly-implicit-euler", .step_s = 0.005};
  d.integrator.linear_solver = solver;
  if (solver != "cholmod") d.integrator.linear_rtol = rtol;
  d.duration_s = duration_s;
  const auto world = loop::assemble(d);
  const VecX before = world->state.q();
  EXPECT_TRUE(loop::run(*world, {}).status.ok());
  return {world->state.q() - before, world->stepper->counters()};
}

// Contact is outside of the pattern of a fused step: one analysis whatever opens and closes, no matrix in
// double, and the motion of a direct solver.
TEST(SoftPair, ContactJoinsTheFusedSteps) {
  scene::Description d = two_blocks(-1e-3);
  d.bodies[1].position_m.x() += 0.003;
  const Ran direct = run_by(d, "cholmod");
  EXPECT_GT(direct.moved.norm(), 1e-4);
  for (const char* solver : {"pcg-single", "pcg-two-level"})
    for (const double rtol : {1e-7, 1e-9}) {  // the second one is below single precision
      const Ran fused = run_by(d, solver, 0.1, rtol);
      const dynamics::StepperCounters& c = fused.counters;
      EXPECT_EQ(c.solver.symbolic, 1) << solver << ", " << rtol;
      EXPECT_EQ(c.tangent_evaluations + c.solver.lagged, 20) << solver << ", " << rtol;
      EXPECT_EQ(c.solver.factorisations, c.tangent_evaluations) << "none was made in double";
      EXPECT_EQ(c.unconverged, 0);
      EXPECT_LT((fused.moved - direct.moved).norm(), 1e3 * rtol * direct.moved.norm())
          << solver << ", " << rtol;
    }
}

// Friction as well, for two steps: where friction sticks, later steps depend on rounding in each step,
// however it is solved.
TEST(SoftPair, FrictionJoinsTheFusedSteps) {
  scene::Description d = two_blocks(-1e-3);
  d.contacts[0].friction = 0.3;
  d.contacts[0].friction_regularisation_m_s = 0.1;
  for (auto& body : d.bodies) body.attachments.clear();
  d.bodies[1].velocity_m_s = Vec3(0.2, 0.1, 0);
  const Ran direct = run_by(d, "cholmod", 0.01);
  d.contacts[0].friction = 0.0;
  EXPECT_GT((run_by(d, "cholmod", 0.01).moved - direct.moved).norm(), 1e-3 * direct.moved.norm());
  d.contacts[0].friction = 0.3;
  for (const char* solver : {"pcg-single", "pcg-two-level"}) {
    const Ran fused = run_by(d, solver, 0.01);
    EXPECT_EQ(fused.counters.solver.symbolic, 1) << solver;
    EXPECT_LT((fused.moved - direct.moved).norm(), 1e-6 * direct.moved.norm()) << solver;
  }
}

// A specified contact that never touches: the same fused steps, except for rounding of their times.
TEST(SoftPair, ContactThatNeverTouchesKeepsTheFusedSteps) {
  scene::Description d = two_blocks(5e-3);
  d.gravity_m_s2 = Vec3(0, 2, 0);
  const Ran named = run_by(d, "pcg-two-level");
  d.contacts.clear();
  const Ran without = run_by(d, "pcg-two-level");
  EXPECT_GT(without.moved.norm(), 1e-4);
  EXPECT_LT((named.moved - without.moved).norm(), 1e-6 * without.moved.norm());
  EXPECT_EQ(named.counters.solver.symbolic, without.counters.solver.symbolic);
  EXPECT_EQ(named.counters.tangent_evaluations, without.counters.tangent_evaluations);
  EXPECT_EQ(named.counters.solver.factorisations, without.counters.solver.factorisations);
}

// Free blocks, one thrown at the other: momentum is conserved, and transferred from one to the other.
TEST(SoftPair, ACollisionKeepsMomentum) {
  scene::Description d = two_blocks(0.5e-3);
  for (auto& body : d.bodies) body.attachments.clear();
  d.bodies[1].velocity_m_s = Vec3(0, 0, -0.3);
  d.duration_s = 0.05;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.001;
  d.integrator.step_s = 0.001;
  const auto world = loop::assemble(d);
  const auto momentum = [&](std::size_t body) {
    Vec3 sum = Vec3::Zero();
    const auto& block = *world->state.layout().find(world->bodies[body].block_id);
    for (Eigen::Index i = 0; i < world->bodies[body].masses.size(); ++i)
      sum += world->bodies[body].masses[i] * world->state.u().segment<3>(block.u_offset + 3 * i);
    return sum;
  };
  const Vec3 before = momentum(0) + momentum(1);
  ASSERT_LT(before.z(), -0.005);
  ASSERT_TRUE(loop::run(*world, {}).status.ok());
  EXPECT_LT((momentum(0) + momentum(1) - before).norm(), 1e-9 * before.norm());
  EXPECT_LT(momentum(0).z(), 0.4 * before.z());
}

TEST(SoftPair, RefusesWhatItCannotDo) {
  const auto refusal = [](const scene::Description& d) {
    try {
      loop::assemble(d);
    } catch (const Error& e) { return std::string(e.what()); }
    return std::string();
  };
  scene::Description d = two_blocks(0.0);
  d.contacts[0].method = "analytic";
  EXPECT_NE(refusal(d).find("method = \"analytic\" does not apply to two soft bodies"), std::string::npos);
  d = two_blocks(0.0);
  d.contacts[0].second = "blok";
  EXPECT_NE(refusal(d).find("nothing is called \"blok\"; use the names of soft bodies, obstacles or tools"),
            std::string::npos);
}

}  // namespace
