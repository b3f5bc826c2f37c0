#include <gtest/gtest.h>

#include "core/rounded_range.h"
#include "loop/small_scenes.h"
#include "palpate/loop/world.h"
#include "session/scene_view.h"
#include "session/shade_values.h"
#include "session/snapshot_scene.h"

using namespace palpate;

// A free block that turns and flies is undeformed; with a fixed face its displacement is the motion itself.
TEST(Shades, AFreeBodyIsColouredWithoutItsRigidMotion) {
  for (const bool free : {true, false}) {
    scene::Description d = small_scenes::held_block();
    if (free) d.bodies[0].attachments.clear();
    ASSERT_EQ(session::is_free(d.bodies[0]), free);
    const auto world = loop::assemble(d);
    session::WorldSnapshot snapshot = session::snapshot_of(*world, 0.0, session::Shade::kDisplacement);
    const Quat turn(Eigen::AngleAxisd(1.0, Vec3::UnitZ()));
    snapshot.nodes[0] = (turn.toRotationMatrix() * snapshot.nodes[0]).colwise() + Vec3(0.5, 0, 0);
    const double largest = session::largest_value(*world, snapshot, session::Shade::kDisplacement);
    const render::Scene drawn = session::scene_of(*world, snapshot, session::Shade::kDisplacement);
    if (free) {
      EXPECT_LT(largest, 1e-12);
      EXPECT_TRUE(drawn.scale.is_flat());
      EXPECT_EQ(drawn.scale.note, "without rigid motion");
    } else {
      EXPECT_GT(largest, 0.45);
      EXPECT_EQ(drawn.scale.low, 0.0);
      EXPECT_EQ(drawn.scale.high, rounded_range(largest));
      EXPECT_EQ(drawn.scale.note, "");
    }
  }
}

#ifdef PALPATE_HAS_TOOL
// Picture and movie of one run have one range of colours, though they show different times.
TEST(Shades, TheRangeIsThatOfTheRun) {
  scene::Description d = small_scenes::pressed_block(-1e-4);
  KeyframeSpec pressed = d.device->keyframes[0];
  pressed.time_s = 0.05;
  pressed.position_m.z() -= 0.004;
  d.device->keyframes = {d.device->keyframes[0], pressed};
  d.duration_s = 0.06;
  const auto world = loop::assemble(d);
  session::LargestValue largest(session::Shade::kDisplacement);
  loop::RunOptions options;
  options.observers = {&largest};
  ASSERT_TRUE(loop::run(*world, options).status.ok());
  EXPECT_GT(largest.value(), 1e-4);
  const session::WorldSnapshot end = session::snapshot_of(*world, 0.06, session::Shade::kDisplacement);
  const render::Scene own = session::scene_of(*world, end, session::Shade::kDisplacement),
                      of_run = session::scene_of(*world, end, session::Shade::kDisplacement,
                                                 10.0 * largest.value());
  EXPECT_LE(own.scale.high, rounded_range(largest.value()));
  EXPECT_EQ(of_run.scale.high, rounded_range(10.0 * largest.value()));
}
#endif

TEST(SceneView, OfTheTableOfTheSceneReplacesTheChosenOne) {
  render::View chosen;
  chosen.azimuth_deg = 75.0;
  const render::View none = session::scene_view({}, chosen);
  EXPECT_EQ(none.azimuth_deg, 75.0);
  EXPECT_FALSE(none.backwards);
  scene::ViewSpec spec;
  spec.direction = Vec3(0, -1, 0);
  spec.zoom = 2.0;
  const render::View view = session::scene_view(spec, chosen);
  EXPECT_EQ(view.backwards, Vec3(0, -1, 0));
  EXPECT_EQ(view.zoom, 2.0);
}
