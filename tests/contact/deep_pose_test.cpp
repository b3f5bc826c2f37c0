// Poses so deep that the shortest exit is on the far side: contact pushes back to the side of entry.
#include "ball_and_slab.h"
#include "proxy/region.h"

using namespace contact_tests;
using namespace contact_tests::ball_and_slab;

// Without proxies: a ball pushed into a slab beyond its middle and out of its far side is pushed back to
// where it entered for as long as they touch. The shortest exit of the hulls is then the opposite way.
TEST(DeepPose, ADeepPoseKeepsItsNormal) {
  for (const bool soft : {false, true}) {
    Pair pair;
    const auto source = pair.source(soft, false, 0.0);
    proxy::RegionFinder finder;
    bool flips = false;
    int pressed = 0;
    for (double z = 0.056; z > -0.03; z -= 0.004) {
      const auto samples = pair.query(*source, Vec3(0.01, 0.02, z));
      const Points of_ball = pair.thrown.model.skin.vertices.colwise() + Vec3(0.01, 0.02, z);
      flips |= finder.find(of_ball, pair.rigid.vertices, 0.0).normal.z() < 0.0;
      const Total force = total(samples, pair.state.view());
      if (z > 0.055) continue;
      EXPECT_GT(force.force.z(), 0.0) << z;
      pressed += force.pressed > 0;
      for (const auto& s : samples) ASSERT_GT(s.normal.z(), 0.5) << z;
    }
    EXPECT_TRUE(flips) << "the case is one";
    EXPECT_GT(pressed, 15);
    EXPECT_GT(source->report().normals_kept, 3);
    // leaves on the far side and returns: now it enters from there
    pair.query(*source, Vec3(0.01, 0.02, -0.1));
    for (const auto& s : pair.query(*source, Vec3(0.01, 0.02, -0.053))) EXPECT_LT(s.normal.z(), -0.5);
  }
}
