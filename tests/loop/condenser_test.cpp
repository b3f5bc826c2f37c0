// The condensed linearisation by conjugate gradients against the factored one, exchange by exchange.
#include "loop/condenser.h"

#include <gtest/gtest.h>

#include "loop/small_scenes.h"
#include "loop/tool_side.h"
#include "palpate/core/counters.h"
#include "palpate/loop/run.h"
#ifdef PALPATE_HAS_TOOL
#include "palpate/tool/tool.h"

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

/// A block of some thousand tetrahedra, in which a ball is pressed and then dragged aside.
scene::Description dragged() {
  scene::Description d = pressed_block(-0.0005);
  d.bodies[0].mesh.size_m = Vec3(0.08, 0.08, 0.03);
  d.bodies[0].mesh.element_size_m = 0.005;
  d.bodies[0].position_m = Vec3(0, 0, 0.015);
  d.tool->position_m.z() += 0.01;
  d.device->keyframes[0].position_m = d.tool->position_m;
  KeyframeSpec down = d.device->keyframes[0], aside = down;
  down.time_s = 0.08;
  down.position_m.z() -= 0.006;
  aside.time_s = 0.2;
  aside.position_m += Vec3(0.015, 0.01, -0.006);
  d.device->keyframes.push_back(down);
  d.device->keyframes.push_back(aside);
  d.contacts[0].stiffness_pa_m = 2e6;
  d.contacts[0].damping_pa_s_m = 2e3;
  d.duration_s = 0.2;
  return d;
}

double relative(const Vec6& unit, const Mat6& a, const Mat6& b, double least = 0.0) {
  const auto size = [&](const Mat6& m) { return (unit.asDiagonal() * m * unit.asDiagonal()).norm(); };
  return size(a - b) / std::max(size(b), least);
}

/// Asks two condensers at each exchange, and keeps the largest differences.
class Beside : public loop::Observer {
 public:
  Beside(double error, double tick) : exact_(0.0, false, 1), quick_(error, false, 1), tick_(tick) {}

  void queried(loop::World& world, double) override {
    const auto& side = loop::ToolSide::of(world);
    contact::FrameLinearisation c;
    world.contact->linearise(world.state.view(), side.frame_index, c, contact::Partners::kNodes);
    if (c.active == 0) return;
    const double period = world.description.exchange.exchange_period_s;
    loop::CondensedAnswer exact[2], quick[2];
    ASSERT_TRUE(exact_.answer(world, period, tick_, c, exact[0], exact[1]));
    ASSERT_TRUE(quick_.answer(world, period, tick_, c, quick[0], quick[1]));
    Vec6 unit = Vec6::Ones();
    unit.head<3>() /= world.description.tool->radius_m;
    for (int k : {0, 1}) {
      J[k] = std::max(J[k], relative(unit, quick[k].J, exact[k].J));
      const double stiffest =
          (unit.asDiagonal() * exact[k].J * unit.asDiagonal()).norm() * (k ? tick_ : period);
      B[k] = std::max(B[k], relative(unit, quick[k].B, exact[k].B, stiffest));
      wrench[k] = std::max(wrench[k], unit.cwiseProduct(quick[k].wrench - exact[k].wrench).norm() /
                                          unit.cwiseProduct(exact[k].wrench).norm());
      answered = std::max(answered, relative(unit, -c.K, exact[k].J));
    }
    ++exchanges;
  }
  double J[2] = {}, B[2] = {}, wrench[2] = {};  ///< after the period, after the tick
  double answered = 0.0;                        ///< of the bodies' answer itself
  int exchanges = 0;
  const loop::CondenserCounters& counters() const { return quick_.counters(); }

 private:
  loop::Condenser exact_, quick_;
  double tick_;
};

std::unique_ptr<Beside> compare(scene::Description d, double error) {
  d.exchange.linearisation = "frozen";
  const auto world = loop::assemble(d);
  auto beside = std::make_unique<Beside>(error, d.tool->tick_s);
  loop::RunOptions options;
  options.observers = {beside.get()};
  EXPECT_TRUE(loop::run(*world, options).status.ok());
  EXPECT_GE(beside->exchanges, 8);
  EXPECT_GT(beside->answered, 0.1) << "bodies that do not answer prove nothing";
  return beside;
}

void expect_within(const Beside& b, double error, double tick_error) {
  for (const double* of : {b.J, b.B, b.wrench}) {
    EXPECT_LT(of[0], error);
    EXPECT_LT(of[1], tick_error);
  }
  EXPECT_EQ(b.counters().exchanges, b.exchanges);
  EXPECT_EQ(b.counters().factored, 0);
}

TEST(Condenser, HasTheErrorThatIsWanted) {
  long products = 0;
  for (const double error : {1e-1, 1e-2, 1e-3}) {
    const auto b = compare(dragged(), error);
    expect_within(*b, error, error);
    EXPECT_LE(b->counters().largest_error, error);
    EXPECT_GT(b->counters().readings, products) << "less error takes more work";
    products = b->counters().readings;
  }
  EXPECT_LT(products, 600);
}

TEST(Condenser, KnowsDrivenNodesAndDampingByMass) {
  scene::Description d = dragged();
  KeyframeSpec start, end;
  end.time_s = 3.0;
  end.position_m = Vec3(0.02, -0.01, 0.03);
  d.bodies[0].attachments[0].keyframes = {start, end};
  d.bodies[0].mass_damping_per_s = 20.0;
  expect_within(*compare(d, 1e-2), 1e-2, 1e-2);
}

// Regions with damping of their own, which is no multiple of the stiffness.
TEST(Condenser, KnowsDampingOfItsOwnInEachBody) {
  scene::Description d = dragged();
  SoftBodySpec second = d.bodies[0];
  second.name = "other";
  second.position_m += Vec3(0.3, 0, 0);
  second.stiffness_damping_s = 0.05;
  for (AttachmentSpec& floor : second.attachments) floor.box_max_m.x() = 2.0;
  d.bodies.push_back(second);
  expect_within(*compare(d, 1e-2), 1e-2, 1e-2);
}

// Of contact 1e5 times as stiff as the body the iteration knows no error that could be trusted.
TEST(Condenser, FactorisesContactFarStifferThanTheBody) {
  scene::Description d = dragged();
  d.contacts[0].stiffness_pa_m = 1e9;
  d.contacts[0].damping_pa_s_m = 0.0;
  const auto b = compare(d, 1e-2);
  EXPECT_EQ(b->counters().factored, b->exchanges);
  EXPECT_LT(b->J[0] + b->J[1] + b->B[0] + b->wrench[0] + b->wrench[1], 1e-9);
}

TEST(Condenser, FactorisesWhereNoErrorIsWantedOrFrictionIsFull) {
  const auto b = compare(dragged(), 0.0);
  EXPECT_EQ(b->counters().factored, b->exchanges);
  EXPECT_EQ(b->J[0] + b->J[1] + b->wrench[0] + b->wrench[1], 0.0);
  scene::Description d = dragged();
  d.contacts[0].friction = 0.3;
  d.contacts[0].friction_tangent = "full";
  d.integrator.linear_solver = "umfpack";
  const auto rough = compare(d, 1e-2);
  EXPECT_EQ(rough->counters().factored, rough->exchanges);
}

TEST(Condenser, FactorisesFriction) {
  scene::Description d = dragged();
  d.contacts[0].friction = 0.3;
  d.contacts[0].friction_tangent = "symmetric";
  const auto b = compare(d, 1e-2);
  EXPECT_EQ(b->counters().factored, b->exchanges);
  EXPECT_LT(b->J[0] + b->J[1] + b->B[0] + b->wrench[0] + b->wrench[1], 1e-9);
}

// The whole loop, felt by the hand.
TEST(Condenser, TheHandFeelsTheSameByEither) {
  const auto force = [](double error) {
    class Forces : public loop::Observer {
     public:
      void tick(const loop::TickRecord& tick) override { felt.push_back(tick.device.force); }
      std::vector<Vec3> felt;
    };
    scene::Description d = dragged();
    d.exchange.linearisation_error = error;
    const auto world = loop::assemble(d);
    Forces forces;
    loop::RunOptions options;
    options.observers = {&forces};
    EXPECT_TRUE(loop::run(*world, options).status.ok());
    return forces.felt;
  };
  const auto exact = force(0.0), quick = force(0.01);
  ASSERT_EQ(exact.size(), quick.size());
  double most = 0.0, difference = 0.0;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    most = std::max(most, exact[k].norm());
    difference = std::max(difference, (exact[k] - quick[k]).norm());
  }
  EXPECT_GT(most, 0.1);
  EXPECT_LT(difference, 0.01 * most);
  EXPECT_GT(difference, 0.0) << "one was taken for the other";
}

}  // namespace
#endif
