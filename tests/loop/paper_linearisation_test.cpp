// Responses of touch-head and touch-human at the point of largest pressure, by a few iterations and by
// factorisations: both at the same state, so that only the linearisation differs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "loop/linearise.h"
#include "loop/tool_instance.h"
#include "palpate/contact/contact_force.h"
#include "palpate/loop/load.h"
#include "palpate/loop/run.h"

using namespace palpate;

namespace {

struct State {
  VecX q, u;
  dynamics::RigidMotion tool;
  double device_force = 0.0;
};

State pressed(const scene::Description& d, double time) {
  struct Feel : loop::Observer {
    void tick(const loop::TickRecord& tick) override { force = tick.device.force.norm(); }
    double force = 0.0;
  } feel;
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.duration_s = time;
  options.observers = {&feel};
  EXPECT_TRUE(loop::run(*world, options).status.ok());
  return {world->state.q(), world->state.u(), {world->tool_pose(), world->tool_twist()}, feel.force};
}

struct Answer {
  Vec6 F;
  Mat6 J, B;
};

Answer answer(scene::Description d, const State& state, double error) {
  d.exchange.linearisation = "points";
  d.exchange.linearisation_error = error;
  const auto world = loop::assemble(d);
  contact::TrajectoryFrame& path = *world->tools[0].partitioned()->path;
  path.clear();
  path.append(0.0, state.tool.pose, state.tool.twist);
  world->state.q() = state.q;
  world->state.u() = state.u;
  world->contact->refresh(world->state.view());
  const double period = d.exchange.exchange_period_s;
  long fallbacks = 0;
  // the first exchange of a run starts its iterations from zero: later ones start from the previous exchange
  const loop::ContactRecord record = loop::linearise_contact(*world, 1, period, fallbacks);
  Answer out;
  contact::ReducedContactStepper ticks(d.contacts);
  ticks.adopt(record.touch);
  const dynamics::LinearisedContact linear = ticks.linearise(period, period, state.tool);
  out.F = Eigen::Map<const Vec6>(linear.F0.data());
  out.J = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(linear.J.data());
  out.B = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(linear.B.data());
  return out;
}

double off(const Mat6& a, const Mat6& b) {
  const Mat3 other = b.bottomRightCorner<3, 3>();
  return (a.bottomRightCorner<3, 3>() - other).norm() / other.norm();
}

}  // namespace

class PaperLinearisation : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, PaperLinearisation, testing::Values("touch-head", "touch-human"),
                         [](const auto& p) {
                           return p.param == std::string("touch-head") ? "head" : "human";
                         });

TEST_P(PaperLinearisation, IterationsAnswerAsFactorsDo) {
  const scene::Description d = loop::load(fmt::format("{}/scenes/{}.toml", PALPATE_SOURCE_DIR, GetParam()));
  ASSERT_TRUE(std::filesystem::exists(d.bodies[0].mesh.file) ||
              std::system(fmt::format("'{}' inspect {} > /dev/null", PALPATE_PROGRAM, GetParam()).c_str()) ==
                  0);
  const State state = pressed(d, 0.2);
  ASSERT_GT(state.device_force, 0.5) << "it presses";
  const Answer factored = answer(d, state, 0.0);
  double last = 1.0;
  for (const double error : {0.1, 0.01, 1e-3}) {
    const Answer iterated = answer(d, state, error);
    const double F = (iterated.F - factored.F).tail<3>().norm() / factored.F.tail<3>().norm(),
                 J = off(iterated.J, factored.J), B = off(iterated.B, factored.B);
    fmt::print("{}, linearisation_error {:g}: wrench off by {:.2g} %, J by {:.2g} %, B by {:.2g} %\n",
               GetParam(), error, 100.0 * F, 100.0 * J, 100.0 * B);
    EXPECT_LT(F, 0.01) << error;
    EXPECT_LT(J, std::max(error, 0.01)) << error;
    EXPECT_LT(J, 1.5 * last) << "more iterations do not answer worse";
    last = J;
  }
}
