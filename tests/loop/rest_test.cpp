// At rest a coupled scene is in equilibrium: with every linearisation, the force on the hand is that of the
// monolithic solution, and constant.
#include <gtest/gtest.h>

#include "palpate/core/named_enum.h"
#include "palpate/loop/run.h"
#include "small_scenes.h"

namespace palpate {
namespace {

struct LastTicks : loop::Observer {
  void tick(const loop::TickRecord& one) override { ticks.push_back(one); }
  std::vector<loop::TickRecord> ticks;
};

/// Contact force at the end, and its range over the last two periods [N].
struct Rest {
  Vec3 force;
  double range = 0.0;
};

Rest at_rest(const scene::Description& d) {
  LastTicks last;
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.observers = {&last};
  EXPECT_TRUE(loop::run(*world, options).status.ok());
  Rest out{last.ticks.back().contact.force};
  for (std::size_t i = last.ticks.size() - 20; i < last.ticks.size(); ++i)
    out.range = std::max(out.range, (last.ticks[i].contact.force - out.force).norm());
  return out;
}

/// A block of many triangles, held below, under a tool that presses it off its centre.
scene::Description pressed_aside(ToolShape shape, const std::string& method) {
  scene::Description d = small_scenes::pressed_block(0.004);
  d.duration_s = 1.2;
  d.tool->position_m.x() = 0.006;
  d.tool->position_m.y() = -0.004;
  d.device->keyframes.front().position_m = d.tool->position_m;
  d.tool->coupling.damping_n_s_m = 8.0;
  d.tool->coupling.rotational_stiffness_n_m_rad = 0.3;
  d.tool->coupling.rotational_damping_n_m_s_rad = 3e-3;
  d.bodies.front().stiffness_damping_s = 5e-3;
  d.contacts.front().method = method;
  d.tool->shape = shape;
  if (shape == ToolShape::kMesh) {
    d.tool->mesh.generator = "ball";
    d.tool->mesh.radius_m = d.tool->radius_m;
    d.tool->mesh.element_size_m = 0.3 * d.tool->radius_m;
    d.tool->inertia_kg_m2 = Vec3::Constant(5e-6);
  }
  return d;
}

struct RestCase {
  ToolShape shape;
  const char *method, *linearisation, *integrator;
};

class RestingContact : public ::testing::TestWithParam<RestCase> {};

TEST_P(RestingContact, HasTheForceOfTheMonolithicSolution) {
  const RestCase c = GetParam();
  scene::Description d = pressed_aside(c.shape, c.method);
  d.integrator.name = c.integrator;
  d.integrator.rtol = 1e-7;  // rtol of error control: the state at rest has that accuracy
  d.exchange.linearisation = c.linearisation;
  scene::Description one = d;
  one.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  const Rest truth = at_rest(one), rest = at_rest(d);
  EXPECT_GT(truth.force.norm(), 0.2);
  EXPECT_LE((rest.force - truth.force).norm(), 1e-6 * truth.force.norm());
  EXPECT_LE(rest.range, 1e-6 * truth.force.norm());
}

INSTANTIATE_TEST_SUITE_P(
    All, RestingContact,
    ::testing::Values(RestCase{ToolShape::kSphere, "analytic", "points", "linearly-implicit-euler"},
                      RestCase{ToolShape::kSphere, "distance", "points", "linearly-implicit-euler"},
                      RestCase{ToolShape::kMesh, "distance", "points", "linearly-implicit-euler"},
                      RestCase{ToolShape::kMesh, "distance", "condensed", "linearly-implicit-euler"},
                      RestCase{ToolShape::kMesh, "distance", "frozen", "linearly-implicit-euler"},
                      RestCase{ToolShape::kSphere, "distance", "points", "cvode-bdf"},
                      RestCase{ToolShape::kSphere, "distance", "frozen", "cvode-bdf"}),
    [](const auto& one) {
      std::string name = std::string(name_of(one.param.shape)) + "_" + one.param.method + "_" +
                         one.param.linearisation + "_" + one.param.integrator;
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

}  // namespace
}  // namespace palpate
