// A million ticks (1000 s) of touch-human's tool at rest against the person, who is frozen.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "loop/long_touch.h"
#include "palpate/loop/load.h"

using namespace palpate;

TEST(MillionTicks, TouchHumanNeitherDriftsNorGrows) {
  // the finger where the scene holds it, 15 mm deep in the belly
  scene::Description d = loop::load(PALPATE_SOURCE_DIR "/scenes/touch-human.toml");
  ASSERT_TRUE(std::filesystem::exists(d.bodies[0].mesh.file) ||
              std::system("'" PALPATE_PROGRAM "' inspect touch-human > /dev/null") == 0)
      << "palpate makes the model";
  d.device->keyframes.erase(d.device->keyframes.begin());  // the first remaining keyframe must have time 0
  d.device->keyframes.resize(1);
  d.device->keyframes[0].time_s = 0.0;
  d.tool->position_m = d.device->keyframes[0].position_m;
  long_touch::freeze(d, 1.0);
  const long_touch::Drift drift = long_touch::rest(d, 1'000'000, 100'000);
  fmt::print(
      "drift from tick 100,000 to 1,000,000: pose {:.2g} (bound {:.2g}), force {:.2g} N (bound {:.2g}), "
      "moment {:.2g} N m, under {:.3g} N; resident memory {:+.3g} MiB\n",
      drift.pose, drift.pose_bound, drift.force, drift.force_bound, drift.moment, drift.pressing_n,
      drift.memory_mib);
  EXPECT_EQ(drift.ticks, 1'000'000);
  long_touch::expect_no_drift(drift);
  EXPECT_LT(drift.memory_mib, 1.0) << "a byte a tick would be 0.9";
}
