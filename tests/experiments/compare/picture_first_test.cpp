// A study started after a picture was drawn: its processes draw as well, and must not inherit the open
// display.
#include <gtest/gtest.h>

#include "core/process_pool.h"
#include "gl/context.h"
#include "palpate/experiments/compare.h"
#include "palpate/loop/load.h"

using namespace palpate;

namespace {

/// A round tool rests 1 mm deep in a soft block.
constexpr const char* kTouch = R"([scene]
name = "touch"
duration_s = 0.02
[[body]]
name = "block"
position_m = [0.0, 0.0, 0.01]
youngs_modulus_pa = 1e4
stiffness_damping_s = 2e-3
[body.mesh]
generator = "box"
size_m = [0.04, 0.04, 0.02]
element_size_m = 0.01
[[body.attachment]]
box_min_m = [-1.0, -1.0, -1e-6]
box_max_m = [1.0, 1.0, 1e-6]
[[contact]]
between = ["block", "tool"]
stiffness_pa_m = 1e7
[tool]
radius_m = 0.015
mass_kg = 0.05
position_m = [0.001, 0.002, 0.034]
[tool.coupling]
stiffness_n_m = 300.0
damping_n_s_m = 4.0
[device]
type = "script"
[[device.keyframe]]
time_s = 0.0
position_m = [0.001, 0.002, 0.034]
[exchange]
exchange_period_s = 0.01
[compare]
contact_methods = ["analytic", "image"]
reference_rtol = 1e-4
reference_check = "cvode-bdf"
reference_check_rtol = 1e-4
[[compare.ladder]]
integrator = "linearly-implicit-euler"
step_s = [0.01]
)";

TEST(Compare, ProcessesDrawAfterAPictureWasDrawn) {
  ProcessPool::prepare();  // as main() does at its start
  gl::Context::shared();
  compare::CompareOptions options;
  options.repeats = 1;
  options.integrators = {"linearly-implicit-euler"};
  const compare::SceneComparison c = compare::run({loop::parse(kTouch, "touch.toml")}, options).scenes[0];
  for (const compare::MissingChart& chart : c.missing_charts) ADD_FAILURE() << chart.text();
  ASSERT_EQ(c.methods.size(), 2u);
  EXPECT_EQ(c.methods[1].method, "image");
  EXPECT_GT(c.methods[1].peak_force_n, 0.0);
}

}  // namespace
