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
  contact.method = "cpu";
  contact.stiffness_pa_m = kStiffness;
  d.contacts.push_back(contact);
  d.gravity_m_s2 = Vec3::Zero();
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.01;
  return d;
}

#ifdef PALPATE_HAS_GL
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

// Outer faces held, pressed into each other by d: two bars of stiffness E A / L and the contact k A in series
// (nu = 0: no lateral strain, so that the uniform stress of a bar solves the block),
//   F = d / (2 L / (E A) + 1 / (k A)),
// which is one block of length 2 L compressed by the rest of d.
TEST(SoftPair, PressedTogetherTheyAreOneBlock) {
  constexpr double d = 1e-3, area = kWidth * kWidth,
                   exact = d / (2 * kLength / (kYoung * area) + 1 / (kStiffness * area));
  scene::Description description = two_blocks(-d);
  description.duration_s = 0.8;
  const auto world = loop::assemble(description);
  ASSERT_TRUE(loop::run(*world, {}).status.ok());
  const Vec3 force = force_on_first(*world);
  EXPECT_NEAR(-force.z() / exact, 1.0, 0.005);
  EXPECT_LT(force.head<2>().norm(), 1e-6 * exact);
  // Symmetric about the middle plane: each face gives way by F L / (E A).
  const double lower = world->positions(world->bodies[0]).row(2).maxCoeff(),
               upper = world->positions(world->bodies[1]).row(2).minCoeff();
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

// Contact stands beside the pattern of a fused step: one analysis whatever opens and closes, no matrix in
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

/// Positions and lagged solves at the end of each period of a run.
class Periods : public loop::Observer {
 public:
  struct One {
    long lagged = 0;
    bool touching = false;
    VecX q;
  };
  void period(loop::World& world, double) override {
    const long now = world.stepper->counters().solver.lagged;
    all.push_back({now - lagged_, force_on_first(world).norm() > 0.0, world.state.q()});
    lagged_ = now;
  }
  std::vector<One> all;  ///< the first is the start

 private:
  long lagged_ = 0;
};

constexpr double kStep = 0.005;
constexpr int kStepsAPeriod = 4;
std::vector<Periods::One> periods_of(scene::Description d, const std::string& solver, double rtol) {
  d.integrator = {.name = "linearly-implicit-euler", .step_s = kStep};
  d.integrator.linear_solver = solver;
  if (solver != "cholmod") d.integrator.linear_rtol = rtol;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = kStepsAPeriod * kStep;
  const auto world = loop::assemble(d);
  Periods periods;
  loop::RunOptions options;
  options.observers = {&periods};
  EXPECT_TRUE(loop::run(*world, options).status.ok());
  return periods.all;
}

double worst_difference(const std::vector<Periods::One>& a, const std::vector<Periods::One>& b) {
  double worst = a.size() == b.size() ? 0.0 : HUGE_VAL;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::max(worst, (a[i].q - b[i].q).norm());
  return worst;
}

// Between two queries a matrix serves the steps after its own where contact is held, and the motion is a
// direct solver's.  A query ends that: no matrix of before serves after it.
TEST(SoftPair, HeldContactIsSolvedByLaggedMatrices) {
  scene::Description d = two_blocks(-1e-3);
  d.bodies[1].position_m.x() += 0.003;
  d.duration_s = 0.5;
  constexpr double kRtol = 1e-5;
  const auto direct = periods_of(d, "cholmod", 0.0);
  const double moved = (direct.back().q - direct.front().q).norm();
  for (const char* solver : {"pcg-single", "pcg-two-level"}) {
    const auto fused = periods_of(d, solver, kRtol);
    long lagged = 0, touching = 0;
    for (std::size_t i = 1; i < fused.size(); ++i) {
      lagged += fused[i].lagged;
      touching += fused[i].touching;
    }
    RecordProperty(std::string(solver) + ", lagged of 100 steps", static_cast<int>(lagged));
    EXPECT_EQ(touching, 25) << solver;
    EXPECT_GT(lagged, 50) << solver;
    EXPECT_LT(worst_difference(fused, direct), 1e3 * kRtol * moved) << solver;
  }
}

// A free block meets the other one between two queries, bounces and flies on: the motion is a direct solver's
// through the blow, whichever matrix was at hand.
TEST(SoftPair, ABlowIsNotSolvedByTheMatrixOfBefore) {
  scene::Description d = two_blocks(6e-3);
  for (auto& body : d.bodies) body.attachments.clear();
  d.bodies[1].velocity_m_s = Vec3(0, 0, -0.3);
  d.duration_s = 0.1;
  constexpr double kRtol = 1e-5;
  const auto direct = periods_of(d, "cholmod", 0.0);
  const double moved = (direct.back().q - direct.front().q).norm();
  EXPECT_FALSE(direct.front().touching);
  EXPECT_TRUE(direct[1].touching) << "it met the other block within the first period";
  for (const char* solver : {"pcg-single", "pcg-two-level"})
    EXPECT_LT(worst_difference(periods_of(d, solver, kRtol), direct), 1e3 * kRtol * moved) << solver;
}

// A block slides on another one, pressed down by its weight.  What its nodes will meet waits in the pattern,
// so that an analysis serves until it has slid by an element: not one at each query.
TEST(SoftPair, ASlideNeedsAnAnalysisAnElementAtMost) {
  constexpr double kElement = 0.01;
  constexpr int kQueries = 60;
  for (const auto& [solver, friction] : {std::pair("cholmod", 0.0), std::pair("gmres", 0.01)}) {
    scene::Description d = two_blocks(0.0);
    d.bodies[0].mesh.size_m = Vec3(0.08, 0.04, 0.02);
    d.bodies[1].attachments.clear();
    d.bodies[1].position_m.x() = -0.015;
    d.bodies[1].velocity_m_s = Vec3(0.05, 0, 0);
    d.gravity_m_s2 = Vec3(0, 0, -2.0);
    d.contacts[0].friction = friction;
    if (friction > 0.0) d.contacts[0].friction_tangent = "full";
    d.integrator = {.name = "linearly-implicit-euler", .step_s = 0.005};
    d.integrator.linear_solver = solver;
    d.duration_s = kQueries * d.exchange.contact_refresh_s;
    const auto world = loop::assemble(d);
    const double from = world->positions(world->bodies[1]).row(0).mean();
    const loop::RunResult result = loop::run(*world, {});
    ASSERT_TRUE(result.status.ok()) << solver;
    const double passed = (world->positions(world->bodies[1]).row(0).mean() - from) / kElement;
    EXPECT_GE(result.contact_queries, kQueries) << solver;
    EXPECT_LT(force_on_first(*world).z(), -0.05) << solver << ": it still lies on the other";
    EXPECT_GT(passed, 2.0) << solver;
    EXPECT_LE(static_cast<double>(result.counters.solver.symbolic), 1.0 + passed) << solver;
  }
}

// With friction as well, for two steps: where friction sticks, more of them depend on the last digit of each,
// whichever way it is solved.
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

// A contact that is named and never touches: the same fused steps, but for the rounding of their times.
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

// Free blocks, one thrown at the other: momentum is conserved, and passes from one to the other.
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
#endif

TEST(SoftPair, RefusesWhatItCannotDo) {
  const auto refusal = [](const scene::Description& d) {
    try {
      loop::assemble(d);
    } catch (const Error& e) { return std::string(e.what()); }
    return std::string();
  };
  scene::Description d = two_blocks(0.0);
  d.contacts[0].method = "analytic";
  EXPECT_NE(refusal(d).find("two soft bodies meet in image space"), std::string::npos);
  d = two_blocks(0.0);
  d.contacts[0].second = "blok";
  EXPECT_NE(refusal(d).find("nothing is called \"blok\"; name soft bodies, obstacles or \"tool\""),
            std::string::npos);
  d.contacts[0].second = "block";
  EXPECT_NE(refusal(d).find("give the body skin = true and proxies = true"), std::string::npos);
}

}  // namespace
