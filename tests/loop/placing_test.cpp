// Tools that assembly moves until they touch, and gaps of a scene's objects at its start.
#include <gtest/gtest.h>

#include <cmath>

#include "loop/clearance.h"
#include "loop/placing.h"
#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/device/device.h"
#include "palpate/loop/run.h"

namespace {

using namespace palpate;

/// The block of 20 mm with its upper face at z = 0.02, and a ball of 15 mm that starts above it.
scene::Description above_block() {
  scene::Description d = small_scenes::pressed_block(-0.1);
  d.contacts[0].method = "distance";
  d.tool->start = ToolStart::kTouching;
  return d;
}

std::string refusal(const scene::Description& d) {
  try {
    loop::assemble(d);
  } catch (const Error& error) { return error.what(); }
  return "accepted";
}

TEST(Placing, ToolTouchesWithinTheToleranceAndKeyframesFollow) {
  scene::Description d = above_block();
  KeyframeSpec later = d.device->keyframes[0];
  later.time_s = 0.02;
  later.position_m.z() -= 0.004;
  d.device->keyframes.push_back(later);
  const auto world = loop::assemble(d);
  ASSERT_EQ(world->placements.size(), 1u);
  const loop::ToolPlacement& placed = world->placements[0];
  // a flat face: the ball touches where its centre is one radius above
  EXPECT_NEAR(placed.position_m.z(), 0.02 + 0.015, loop::kTouchingGap);
  EXPECT_GE(placed.position_m.z(), 0.02 + 0.015) << "outside";
  EXPECT_NEAR(placed.moved_m, 0.1, loop::kTouchingGap);
  EXPECT_EQ(placed.touched, "block");
  EXPECT_NEAR((placed.touch_m - Vec3(0.001, 0.002, 0.02)).norm(), 0.0, 1e-9);
  EXPECT_EQ((world->tool_pose().translation - placed.position_m).norm(), 0.0);
  const std::vector<KeyframeSpec>& keyframes = world->description.device->keyframes;
  EXPECT_EQ((keyframes[0].position_m - placed.position_m).norm(), 0.0);
  EXPECT_NEAR((keyframes[1].position_m - keyframes[0].position_m - Vec3(0, 0, -0.004)).norm(), 0.0, 1e-15);
}

/// A handle without a place in space of its own.
class Pointer : public device::Device {
 public:
  explicit Pointer(std::vector<Pose>& starts) : starts_(starts) {}
  device::DeviceSpecification specification() const override { return {}; }
  void start_at(const Pose& start) override { starts_.push_back(start); }

 protected:
  device::HandleSample do_sample(double) override { return {}; }

 private:
  std::vector<Pose>& starts_;
};

TEST(Placing, DeviceOfTheCallerStartsAtThePlacedTool) {
  scene::Description d = above_block();
  d.tool->rotation_vector_rad = Vec3(0.1, 0.2, 0.3);
  std::vector<Pose> starts;
  const auto world = loop::assemble(d, std::make_unique<Pointer>(starts));
  ASSERT_EQ(starts.size(), 1u);
  EXPECT_EQ((starts[0].translation - world->placements.at(0).position_m).norm(), 0.0);
  EXPECT_NEAR(starts[0].translation.z(), 0.02 + 0.015, loop::kTouchingGap) << "not 0.1 m above";
  EXPECT_NEAR(starts[0].rotation.angularDistance(quaternion_of(Vec3(0.1, 0.2, 0.3))), 0.0, 1e-12);
}

// Along a slanted direction the ball touches first with the side of its direction of motion only on a curved
// body; on the flat face the distance is the height over the cosine.
TEST(Placing, DirectionMayHaveAnyLengthAndSlope) {
  scene::Description d = above_block();
  d.tool->start_direction = Vec3(0, 0.3, -3);
  const double cosine = 3 / std::hypot(0.3, 3.0);
  const auto world = loop::assemble(d);
  EXPECT_NEAR(world->placements.at(0).moved_m, 0.1 / cosine, 2e-6);
}

TEST(Placing, MeshToolTouchesByItsLowestCorner) {
  scene::Description d = above_block();
  d.tool->shape = ToolShape::kMesh;
  d.tool->mesh.generator = "box";
  d.tool->mesh.size_m = Vec3::Constant(0.01);
  d.tool->mesh.element_size_m = 0.01;
  d.tool->inertia_kg_m2 = Vec3::Constant(1e-6);
  d.tool->rotation_vector_rad = Vec3(M_PI / 4, 0, 0);  // an edge points down
  const auto world = loop::assemble(d);
  EXPECT_NEAR(world->placements.at(0).position_m.z(), 0.02 + 0.005 * std::sqrt(2.0), 2e-6);
}

TEST(Placing, ObstacleThatIsNearerIsTouchedFirst) {
  scene::Description d = above_block();
  ObstacleSpec plate;
  plate.name = "plate";
  plate.type = "plane";
  plate.shape["position_m"] = Vec3(0, 0, 0.05);
  d.obstacles.push_back(plate);
  ContactSpec contact = d.contacts[0];
  contact.first = "plate";
  d.contacts.push_back(contact);
  const auto world = loop::assemble(d);
  EXPECT_EQ(world->placements.at(0).touched, "plate");
  EXPECT_NEAR(world->placements.at(0).position_m.z(), 0.065, 2e-6);
}

TEST(Placing, RejectsWhatCannotBePlaced) {
  scene::Description d = above_block();
  d.tool->start_direction = Vec3(0, 0, 1);
  EXPECT_NE(refusal(d).find("missed \"block\", by 100 mm at the closest"), std::string::npos) << refusal(d);
  d = above_block();
  d.tool->start_direction.setZero();
  EXPECT_NE(refusal(d).find("has no direction"), std::string::npos) << refusal(d);
  d = above_block();
  d.tool->position_m.z() = 0.03;  // 5 mm deep: 5 mm back along z
  EXPECT_NE(refusal(d).find("starts 5 mm inside \"block\"; begin outside: move position_m by at least 5 mm "
                            "along (0, 0, 1)"),
            std::string::npos)
      << refusal(d);
  d = above_block();
  d.contacts.clear();
  EXPECT_NE(refusal(d).find("no [[contact]] lists the tool"), std::string::npos) << refusal(d);
  d = above_block();
  d.device->type = "recording";
  EXPECT_NE(refusal(d).find("recorded positions"), std::string::npos) << refusal(d);
}

TEST(Placing, ToolThatIsPlacedByHandDoesNotMove) {
  scene::Description d = above_block();
  d.tool->start = ToolStart::kPlaced;
  const auto world = loop::assemble(d);
  EXPECT_TRUE(world->placements.empty());
  EXPECT_NEAR(world->tool_pose().translation.z(), 0.02 + 0.015 + 0.1, 1e-15);
}

TEST(Clearance, ListsEveryPairWithGapAndWayOut) {
  scene::Description d = small_scenes::pressed_block(0.004);
  ObstacleSpec wall;
  wall.name = "wall";
  wall.type = "plane";
  wall.shape["position_m"] = Vec3(0, 0, -0.003);
  d.obstacles.push_back(wall);
  const auto world = loop::assemble(d);
  const std::vector<loop::Clearance> all = loop::clearances(*world);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].first, "tool");
  EXPECT_EQ(all[0].second, "block");
  EXPECT_TRUE(all[0].in_contact);
  EXPECT_NEAR(all[0].gap.distance, -0.004, 1e-12);
  EXPECT_NEAR((all[0].way_out_m - Vec3(0, 0, 0.004)).norm(), 0.0, 2e-6);
  EXPECT_EQ(all[1].second, "wall");
  EXPECT_NEAR(all[1].gap.distance, 0.023 - 0.004, 1e-12);
  EXPECT_EQ(all[2].first, "block");
  EXPECT_NEAR(all[2].gap.distance, 0.003, 1e-12);
  EXPECT_FALSE(all[2].in_contact);
}

}  // namespace
