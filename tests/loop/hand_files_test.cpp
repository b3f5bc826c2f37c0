// Files of a hand: the times of its recording, the bounds of its poses, the ticks at its device's limit.
#include <gtest/gtest.h>

#include <filesystem>

#include "loop/haptic_record.h"
#include "loop/pose_bounds.h"
#include "loop/tool_instance.h"
#include "messages.h"
#include "palpate/core/error.h"
#include "palpate/device/keyframes.h"
#include "palpate/device/profile.h"
#include "palpate/loop/recorder.h"
#include "palpate/loop/run.h"
#include "small_scenes.h"
#include "store/force_file.h"
#include "temporary_folder.h"

namespace {

using namespace palpate;
using palpate::expectations::message_of;

/// A scene of 0.5 s with a recording at these times.
scene::Description held_by(const TemporaryFolder& folder, const std::vector<double>& times) {
  scene::Description d = small_scenes::pressed_block(0.002);
  d.duration_s = 0.5;
  d.path = (folder / "scene.toml").string();
  d.device->type = "recording";
  d.device->file = "hand.csv";
  std::string text = "time_s,px_m,py_m,pz_m,qw,qx,qy,qz\n";
  for (const double t : times) text += fmt::format("{},0,0,0.035,1,0,0,0\n", t);
  folder.write("hand.csv", text);
  return d;
}

std::string refusal(const scene::Description& d) {
  return message_of([&] { loop::assemble(d); });
}

TEST(RecordedTimes, OfAnotherClockAreRefusedWithTheKeysThatMendThem) {
  const TemporaryFolder folder;
  struct Case {
    std::vector<double> times;
    std::string expected;
  };
  const std::string ranges = "device: hand.csv: the times of the recording are ";
  const Case cases[] = {
      {{1.7e9, 1.7e9 + 0.5},
       "1700000000 to 1700000000.5 s, those of the scene 0 to 0.5 s; set device.time_offset_s = -1700000000 "
       "to start with the scene"},
      {{1.7e12, 1.7e12 + 500},
       "1.7e+12 to 1.7000000005e+12 s, those of the scene 0 to 0.5 s; set device.time_scale = 0.001 if they "
       "are in units of 0.001 s, and device.time_offset_s = -1700000000 to start with the scene"},
      {{1.7e15, 1.7e15 + 500000},
       "1.7e+15 to 1.7000000005e+15 s, those of the scene 0 to 0.5 s; set device.time_scale = 1e-06 if they "
       "are in units of 1e-06 s, and device.time_offset_s = -1700000000 to start with the scene"},
      {{0, 10, 490},
       "0 to 490 s, those of the scene 0 to 0.5 s; set device.time_scale = 0.001 if they are in units of "
       "0.001 s, device.time_scale = 1 if they are seconds"},
      {{0, 1000, 490000},
       "0 to 490000 s, those of the scene 0 to 0.5 s; set device.time_scale = 1e-06 if they are in units of "
       "1e-06 s, device.time_scale = 1 if they are seconds"},
      {{-3, -1},
       "-3 to -1 s, those of the scene 0 to 0.5 s; set device.time_offset_s = 3 to start with the scene"},
      {{0.5, 0.9},
       "0.5 to 0.9 s, those of the scene 0 to 0.5 s; set device.time_offset_s = -0.5 to start with the "
       "scene"}};
  for (const Case& one : cases) {
    const std::string said = refusal(held_by(folder, one.times));
    EXPECT_TRUE(said.ends_with(": " + ranges + one.expected)) << said;
  }
  EXPECT_EQ(std::size(cases), 7u);
}

TEST(RecordedTimes, OfTheSceneAreTaken) {
  const TemporaryFolder folder;
  for (const std::vector<double>& times :
       {std::vector<double>{0, 0.5}, {-1, 1}, {0.2, 0.3}, {0.0}, {0.4, 15.0}, {-2, 0}})
    EXPECT_EQ(refusal(held_by(folder, times)), "") << times.front();
  scene::Description d = held_by(folder, {1.7e12, 1.7e12 + 500});
  d.device->time_scale = 1e-3;
  d.device->time_offset_s = -1.7e9;
  EXPECT_EQ(refusal(d), "");
  d = held_by(folder, {0, 10, 490});
  d.device->time_scale = 1.0;
  EXPECT_EQ(refusal(d), "") << "who says seconds means seconds";
}

// A run's record of the hand uses the same keys, and its velocities are scaled by them.
TEST(RecordedTimes, OfARunsRecordAreShiftedAndScaled) {
  const TemporaryFolder folder;
  scene::Description d = small_scenes::pressed_block(0.0);
  d.duration_s = 0.1;
  KeyframeSpec down = d.device->keyframes.front();
  down.time_s = 0.1;
  down.position_m.z() -= 0.008;
  d.device->keyframes.push_back(down);
  {
    loop::HapticRecorder recorder(folder / "haptic.h5");
    const auto world = loop::assemble(d);
    loop::RunOptions options;
    options.observers = {&recorder};
    ASSERT_TRUE(loop::run(*world, options).status.ok());
  }
  scene::Description slow = d;
  slow.path = (folder / "scene.toml").string();
  slow.device->type = "recording";
  slow.device->file = "haptic.h5";
  slow.device->time_scale = 2.0;
  slow.device->time_offset_s = 0.03;
  const auto world = loop::assemble(slow);
  const auto path = world->tools[0].device->path();
  const auto truth = [&](double t) { return device::sample_keyframes(d.device->keyframes, t); };
  for (const double t : {0.01, 0.04, 0.055}) {
    EXPECT_LT((path(0.03 + 2.0 * t).pose.translation - truth(t).pose.translation).norm(), 1e-9) << t;
    EXPECT_LT((path(0.03 + 2.0 * t).twist.linear - 0.5 * truth(t).twist.linear).norm(), 1e-6) << t;
  }
  slow.device->time_offset_s = 1e6;
  EXPECT_NE(refusal(slow).find("haptic.h5: the times of the recording are 1000000 to 1000000.2 s"),
            std::string::npos);
}

// The bounds of poses extend beyond the scene by the scene's width and an arm's length, and scale with the
// scene.
TEST(PoseBounds, FollowTheScene) {
  scene::Description d = small_scenes::pressed_block(0.0);
  const auto bounds = [](const scene::Description& scene) {
    const auto world = loop::assemble(scene);
    return loop::pose_bounds(*world, device::figures_of(*scene.device).workspace);
  };
  const device::PoseBounds small = bounds(d);
  EXPECT_LT((small.center - Vec3(0, 0, 0.02)).norm(), 0.02);
  EXPECT_GT(small.radius, 1.0);
  EXPECT_LT(small.radius, 1.2);
  EXPECT_TRUE(small.hold({Quat::Identity(), Vec3(0, 0, 0.9)}, {}));
  EXPECT_FALSE(small.hold({Quat::Identity(), Vec3(0, 0, 1e300)}, {}));
  EXPECT_FALSE(small.hold({Quat::Identity(), Vec3(0, 0, 0)}, {Vec3::Zero(), Vec3(1e4, 0, 0)}));
  EXPECT_TRUE(small.hold({Quat::Identity(), Vec3(0, 0, 0)}, {Vec3(0, 30, 0), Vec3(5, 0, 0)}));
  small_scenes::add_floor(d, d.contacts.front());
  EXPECT_LT(bounds(d).radius, 5.0) << "a plane has no end, the scene has";
  d.device->workspace_radius_m = 30.0;
  EXPECT_GT(bounds(d).radius, 90.0) << "a workspace is a part of it";
}

// force.csv marks the ticks that the run counts: those whose requested force exceeded the device's maximum,
// but not those in which the force ramps up, or is slightly reduced by the smooth limit.
TEST(ForceFile, MarksTheTicksThatTheRunCounts) {
  for (const char* profile : {"", "omni"}) {
    const TemporaryFolder folder;
    scene::Description d = small_scenes::pressed_block(0.0);
    d.duration_s = 0.2;
    d.record.emplace();
    d.record->states = false;
    KeyframeSpec down = d.device->keyframes.front();
    down.time_s = 0.2;
    down.position_m.z() -= 0.012;
    d.device->keyframes.push_back(down);
    d.device->max_force_n = 0.5;
    d.device->profile = profile;
    d.device->ramp_s = 0.05;
    d.device->workspace_center_m = d.tool->position_m;
    const auto world = loop::assemble(d);
    loop::Recorder recorder(*world, folder.string());
    loop::RunOptions options;
    options.observers = {&recorder};
    const loop::RunResult result = loop::run(*world, options);
    recorder.close();
    long marked = 0;
    for (const store::ForceRow& row : store::read_forces(folder / "force.csv")) marked += row.limited;
    EXPECT_EQ(marked, result.limited_ticks) << profile;
    EXPECT_GT(marked, 10);
    EXPECT_LT(marked, 190);
  }
}

}  // namespace
