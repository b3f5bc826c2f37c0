// The tick thread neither allocates nor frees memory: ticks of one tool, of a tool on an obstacle, and of two
// tools that meet.  Nor does the check of penetration at each period.
#include <gtest/gtest.h>

#include <deque>

#include "loop/contact_record.h"
#include "loop/penetration_warning.h"
#include "loop/small_scenes.h"
#include "loop/tick_group.h"
#include "malloc_count.h"
#include "palpate/dynamics/linearised_contact.h"
#include "palpate/loop/run.h"
#include "pressing_hand.h"

namespace {

using namespace palpate;
using pressing_hand::ball_on_floor;
using pressing_hand::scene_of;

#if PALPATE_CAN_COUNT
/// Allocations in ticks 2 to 2500: a simulated hand clears its list of wrenches after 2048 of them.
/// @param mode  with "control" the contact pulls the hand along, so that the controller acts
long allocations_in_ticks(const std::string& device, device::PassivityController::Mode mode) {
  using Mode = device::PassivityController::Mode;
  scene::Description d = scene_of();
  d.device->type = device;
  d.device->delay_s = 2e-3;
  d.device->device_friction_n = 0.1;
  d.device->encoder_resolution_m = 1e-5;
  d.device->velocity_cutoff_per_s = 100.0;
  d.device->force_resolution_n = 0.01;
  const auto world = loop::assemble(d);
  loop::ToolInstance& tool = world->tools[0];
  tool.passivity = device::make_passivity_controller(mode, *d.device, d.tool->tick_s);
  loop::HapticLoop ticks(tool);
  ticks.start(0.0);
  dynamics::LinearisedContact record;
  for (std::size_t i = 0; i < 6; ++i) record.J[7 * i] = i < 3 ? -0.1 : -1e3;
  record.version = 1;
  record.source = dynamics::LinearisedContact::Source::kFrozen;
  record.samples = 1;
  const Vec3 start = d.tool->position_m;
  record.x0 = {1, 0, 0, 0, start.x(), start.y(), start.z() - (mode == Mode::kControl ? 0.02 : 0.0)};
  loop::TickRecord out;
  EXPECT_TRUE(ticks.tick(1e-3, 1e-3, record, out).ok());
  const long before = malloc_calls;
  bool ok = true;
  for (int i = 2; i <= 2500; ++i) ok = ticks.tick(1e-3 * i, 1e-3, record, out).ok() && ok;
  const long taken = malloc_calls - before;
  EXPECT_TRUE(ok);
  EXPECT_GT(out.requested.force.norm(), 0.1);
  EXPECT_EQ(tool.passivity && tool.passivity->active_ticks() > 0, mode == Mode::kControl);
  return taken;
}

/// Allocations in ticks 31 to 300 on the floor, including queries: the first three queries grow their
/// buffers.
long allocations_on_floor(bool mesh) {
  scene::Description d = ball_on_floor();
  if (mesh) {
    d.tool->shape = ToolShape::kMesh;
    d.tool->mesh.generator = "ball";
    d.tool->mesh.radius_m = d.tool->radius_m;
    d.tool->mesh.element_size_m = 0.2 * d.tool->radius_m;
    d.tool->inertia_kg_m2 = Vec3::Constant(1e-5);
  }
  const auto world = loop::assemble(d);
  loop::HapticLoop ticks(d, world->tools[0]);
  loop::TickGroup group(std::vector<loop::TickGroup::Member>{{0, &ticks}});
  ticks.start(0.0);
  loop::TickRecord out;
  const loop::ContactRecord none;
  bool ok = true;
  long before = 0;
  for (int i = 1; i <= 300; ++i) {
    if (i == 31) before = malloc_calls;
    const double t = 1e-3 * i;
    group.find_contact(t, 1e-3, [&](std::size_t) -> const loop::ContactRecord& { return none; });
    ok = ticks.tick(t, 1e-3, group.contact(0), out).ok() && ok;
  }
  const long taken = malloc_calls - before;
  EXPECT_TRUE(ok);
  EXPECT_GT(out.contact.force.z(), 0.1);
  return taken;
}
#endif

TEST(RealTime, ATickOnAnObstacleTakesNoMemory) {
#if PALPATE_CAN_COUNT
  for (const bool mesh : {false, true}) EXPECT_EQ(allocations_on_floor(mesh), 0) << mesh;
#else
  GTEST_SKIP() << "a sanitizer brings its own malloc";
#endif
}

#if PALPATE_CAN_COUNT
/// Allocations in ticks 150 to 400 of two tools, with a mesh on top, that two hands press on each other.
long allocations_of_two(bool round) {
  scene::Description d = ball_on_floor();
  d.obstacles.clear();
  d.tool->shape = ToolShape::kMesh;
  d.tool->mesh.generator = "ball";
  d.tool->mesh.radius_m = d.tool->radius_m;
  d.tool->mesh.element_size_m = 0.2 * d.tool->radius_m;
  d.tool->inertia_kg_m2 = Vec3::Constant(1e-5);
  scene::HandSpec& below = d.hands.emplace_back(scene::HandSpec{"below", *d.tool, *d.device});
  if (round) below.tool.shape = ToolShape::kSphere;
  below.tool.position_m *= -1.0;
  for (KeyframeSpec& k : below.device.keyframes) k.position_m *= -1.0;
  d.contacts[0].second = "below";
  d.contacts[0].method = "auto";
  d.contacts[0].friction = 0.3;
  const auto world = loop::assemble(d);
  std::deque<loop::HapticLoop> ticks;
  for (std::size_t i = 0; i < 2; ++i) ticks.emplace_back(d, world->tools[i]).start(0.0);
  loop::TickGroup group(std::vector<loop::TickGroup::Member>{{0, &ticks[0]}, {1, &ticks[1]}});
  const loop::ContactRecord none;
  loop::TickRecord out;
  bool ok = true;
  long before = 0;
  for (int n = 1; n <= 400; ++n) {
    if (n == 150) before = malloc_calls;
    const double t = 1e-3 * n;
    group.find_contact(t, 1e-3, [&](std::size_t) -> const loop::ContactRecord& { return none; });
    for (std::size_t i = 0; i < 2; ++i) ok = ticks[i].tick(t, 1e-3, group.contact(i), out).ok() && ok;
  }
  const long taken = malloc_calls - before;
  EXPECT_TRUE(ok);
  EXPECT_GT(out.contact.force.norm(), 0.1);
  return taken;
}
#endif

TEST(RealTime, ATickOfTwoToolsThatMeetTakesNoMemory) {
#if PALPATE_CAN_COUNT
  for (const bool round : {false, true}) EXPECT_EQ(allocations_of_two(round), 0) << round;
#else
  GTEST_SKIP() << "a sanitizer brings its own malloc";
#endif
}

// The tick thread neither allocates nor frees memory in any tick, with a scripted and with a simulated hand,
// with and without an active passivity controller.
TEST(RealTime, ATickTakesNoMemory) {
#if PALPATE_CAN_COUNT
  using Mode = device::PassivityController::Mode;
  for (const char* device : {"script", "hand"})
    for (const Mode mode : {Mode::kOff, Mode::kObserve, Mode::kControl})
      EXPECT_EQ(allocations_in_ticks(device, mode), 0) << device << ", mode " << static_cast<int>(mode);
#else
  GTEST_SKIP() << "a sanitizer brings its own malloc";
#endif
}

// While the tool touches the block, and no warning is due.
TEST(PenetrationWarning, TakesNoMemoryUntilItIsDue) {
#if PALPATE_CAN_COUNT
  scene::Description d = small_scenes::pressed_block(0.003);
  d.contacts[0].method = "distance";
  const auto world = loop::assemble(d);
  loop::PenetrationWarning warning;
  loop::RunOptions options;
  options.observers = {&warning};
  ASSERT_TRUE(loop::run(*world, options).status.ok());
  ASSERT_GT(world->contact->deepest(0), 0.0);
  const long before = malloc_calls;
  warning.period(*world, 1.0);
  warning.queried(*world, 1.0);
  EXPECT_EQ(malloc_calls - before, 0);
#else
  GTEST_SKIP() << "a sanitizer brings its own malloc";
#endif
}

}  // namespace
