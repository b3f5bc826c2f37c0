// A study started after a picture was drawn: its processes draw as well, and must not inherit the open
// display.
#include <gtest/gtest.h>

#include "core/process_pool.h"
#include "experiments/compare/scenes.h"
#include "gl/context.h"

using namespace palpate;

namespace {

/// A round tool rests 1 mm deep in a soft block.
const std::string kTouch = compare_scenes::touch_text("0.034", "", "", R"([exchange]
exchange_period_s = 0.01
[compare]
duration_s = 0.02
contact_methods = ["analytic", "image"]
reference_rtol = 1e-4
reference_check = "cvode-bdf"
reference_check_rtol = 1e-4
[[compare.ladder]]
integrator = "linearly-implicit-euler"
step_s = [0.01]
)");

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
