// A tool and the bodies that it touches in one linearly implicit step: with the tool eliminated, and an
// iterated mixed-precision matrix, as with the whole matrix.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "loop/tool_in_step.h"
#include "palpate/loop/run.h"

#ifdef PALPATE_HAS_TOOL

using namespace palpate;
using tool_in_step::pressed;

namespace {

scene::Description with_friction(FrictionTangent tangent) {
  scene::Description d = pressed();
  d.contacts[0].friction = 0.4;
  d.contacts[0].friction_tangent = tangent;
  return d;
}

scene::Description pressed_by_two() {
  scene::Description d = pressed(0.012);
  scene::HandSpec& other = d.hands.emplace_back();
  other.name = "left";
  other.tool = *d.tool;
  other.device = *d.device;
  for (KeyframeSpec& frame : other.device.keyframes) frame.position_m.x() -= 0.032;
  other.tool.position_m.x() -= 0.032;
  d.contacts.push_back(d.contacts[0]);
  d.contacts.back().second = "left";
  return d;
}

scene::Description pressed_by_a_hand() {
  scene::Description d = pressed();
  d.device->type = "hand";
  return d;
}

/// The block's lower face is shaken.
scene::Description pressed_while_it_moves() {
  scene::Description d = pressed();
  KeyframeSpec frame;
  d.bodies[0].attachments[0].keyframes.push_back(frame);
  frame.time_s = 0.04;
  frame.position_m = Vec3(0.002, 0.0, 0.001);
  d.bodies[0].attachments[0].keyframes.push_back(frame);
  return d;
}

struct Ran {
  VecX q, moved;
  loop::RunResult result;
};

Ran run(scene::Description d, const std::string& solver, double rtol, int threads = 1) {
  d.integrator.linear_solver = solver;
  d.integrator.linear_rtol = rtol;
  d.integrator.threads = threads;
  const auto world = loop::assemble(d);
  const VecX start = world->state.q();
  Ran out;
  out.result = loop::run(*world, {});
  EXPECT_TRUE(out.result.status.ok()) << out.result.status.message;
  out.q = world->state.q();
  out.moved = out.q - start;
  return out;
}

double difference(const Ran& a, const Ran& b) { return (a.q - b.q).norm() / b.moved.norm(); }

struct Case {
  const char* name;
  std::function<scene::Description()> scene;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {"beside the centre", [] { return pressed(); }},
      {"symmetric friction", [] { return with_friction(FrictionTangent::kSymmetric); }},
      {"friction of the step's end", [] { return with_friction(FrictionTangent::kSecant); }},
      {"two tools", pressed_by_two},
      {"a hand in the State", pressed_by_a_hand},
      {"a moving attachment", pressed_while_it_moves}};
  return all;
}

// Their difference is that of the iteration's tolerance.
TEST(ToolInStep, StepsAsByTheWholeMatrix) {
  for (const Case& c : cases()) {
    const Ran exact = run(c.scene(), "umfpack", 1e-8);
    ASSERT_EQ(exact.result.counters.solver.lagged, 0);
    for (const char* solver : {"pcg-single", "pcg-two-level", "auto"}) {
      double last = HUGE_VAL;
      for (const double rtol : {1e-4, 1e-7, 1e-10}) {
        const Ran iterated = run(c.scene(), solver, rtol);
        const double error = difference(iterated, exact);
        EXPECT_LT(error, std::max(10.0 * rtol, 1e-9)) << c.name << ", " << solver << ", " << rtol;
        EXPECT_LT(error, last) << c.name << ", " << solver << ", " << rtol;
        last = error;
        const auto& counters = iterated.result.counters;
        EXPECT_GT(counters.solver.lagged, 0) << c.name << ", " << solver << ", " << rtol;
        EXPECT_GE(counters.solver.residual_checks, counters.steps) << "all by refinement";
        EXPECT_EQ(counters.lu, 0);
      }
    }
  }
}

TEST(ToolInStep, IsTheSameWithTwoThreads) {
  for (const Case& c : cases()) {
    const Ran one = run(c.scene(), "auto", 1e-4, 1), two = run(c.scene(), "auto", 1e-4, 2);
    EXPECT_EQ(one.q, two.q) << c.name;
  }
}

}  // namespace

#endif
