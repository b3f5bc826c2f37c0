// Properties of every device: opened by its first sample, the same sample for the same time, a specification,
// and, where it has a path, samples that lie on it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "messages.h"
#include "palpate/core/error.h"
#include "palpate/device/device.h"
#include "palpate/device/limiter.h"
#include "palpate/device/profile.h"
#include "palpate/device/registry.h"
#include "stand_ins.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace palpate::device;
using palpate::expectations::expect_contains;
using palpate::expectations::message_of;

namespace {

/// A user-defined device, as docs/devices.md shows.
class Counted : public Device {
 public:
  DeviceSpecification specification() const override { return {}; }
  int opened = 0, closed = 0;
  Wrench felt;
  double felt_at = -1.0;

 protected:
  void do_open() override { ++opened; }
  void do_close() override { ++closed; }
  HandleSample do_sample(double t) override {
    HandleSample out;
    out.pose = {quaternion_of(Vec3(0, 0, t)), Vec3(t, 0, 0)};
    out.twist = {Vec3(0, 0, 1), Vec3(1, 0, 0)};
    return out;
  }
  void do_feedback(double t, const Wrench& on_hand) override { felt = on_hand, felt_at = t; }
};

/// Returns a spec with which the listed device can be made.
DeviceSpec spec_of(const std::string& type, const TemporaryFolder& folder) {
  DeviceSpec spec;
  spec.type = type;
  spec.keyframes = {{0.1, Vec3(0.1, 0, 0), Vec3(0, 0, 0.2), Interpolation::kMinimumJerk},
                    {1.2, Vec3(0, 0.1, 0), Vec3(0, 0.3, 0), Interpolation::kMinimumJerk}};
  folder.write("poses.csv",
               "time_s,px_m,py_m,pz_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n0.5,0.1,0,0,1,0,0,0\n1,0,0,0,0,1,0,0\n");
  spec.file = "poses.csv";
  spec.port = 47931;
  if (type == "plugin") spec.library = std::string(PALPATE_DRIVERS) + "/driver.so";
  if (type == "spacemouse") spec.input = (folder / "spnav.sock").string();
  if (type == "gamepad") spec.input = (folder / "event0").string();
  return spec;
}

}  // namespace

TEST(Device, opens_before_its_first_sample_and_closes_once) {
  Counted device;
  EXPECT_EQ(device.opened, 0);
  EXPECT_EQ(device.position(), Vec3(0, 0, 0));
  expect_contains(message_of([&] { device.feedback(0.0, {}); }), "wrench sent to a closed device");
  device.sample(0.5);
  device.sample(0.6);
  EXPECT_EQ(device.opened, 1);
  EXPECT_EQ(device.position(), Vec3(0.6, 0, 0));
  EXPECT_EQ(device.linear_velocity(), Vec3(1, 0, 0));
  EXPECT_EQ(device.angular_velocity(), Vec3(0, 0, 1));
  EXPECT_NEAR(rotation_vector(device.rotation()).z(), 0.6, 1e-15);
  EXPECT_EQ(device.switches(), 0u);
  device.set_force_and_torque(Vec3(1, 2, 3), Vec3(4, 5, 6));
  EXPECT_EQ(device.felt.force, Vec3(1, 2, 3));
  EXPECT_EQ(device.felt.moment, Vec3(4, 5, 6));
  EXPECT_EQ(device.felt_at, 0.6);
  device.close();
  device.close();
  EXPECT_EQ(device.closed, 1);
  EXPECT_FALSE(device.is_open());
  device.open();
  EXPECT_EQ(device.opened, 2);
}

// Conformance suite: every device of the registry.
TEST(Device, every_listed_one_samples) {
  const TemporaryFolder folder;
  SpacemouseServer server((folder / "spnav.sock").string());
  EventPipe pipe((folder / "event0").string());
  int paths = 0;
  for (const auto& entry : device_registry()) {
    const DeviceSpec spec = spec_of(entry.name, folder);
    const auto device = make_device(spec, folder.string());
    EXPECT_FALSE(device->specification().name.empty()) << entry.name;
    EXPECT_EQ(device->specification().max_force.value(), 3.3) << entry.name;
    for (int i = 0; i < 150; ++i) {
      const double t = 0.01 * i;
      const HandleSample s = device->sample(t), again = device->sample(t);
      EXPECT_TRUE(s.pose.translation.allFinite() && s.twist.angular.allFinite()) << entry.name;
      EXPECT_NEAR(s.pose.rotation.norm(), 1.0, 1e-14) << entry.name;
      EXPECT_EQ(s.pose.translation, again.pose.translation) << entry.name;
      EXPECT_EQ(s.twist.linear, device->linear_velocity()) << entry.name;
      device->feedback(t, {});
    }
    const auto path = device->path();
    if (!path) continue;
    for (const double t : {-0.5, 0.0, 0.3, 0.9, 2.0}) {  // at any time, in any order
      const HandleSample s = make_device(spec, folder.string())->sample(t), p = path(t);
      EXPECT_EQ(p.pose.translation, s.pose.translation) << entry.name;
      EXPECT_EQ(p.twist.angular, s.twist.angular) << entry.name;
    }
    ++paths;
  }
  EXPECT_EQ(device_registry().size(), 7u);
  EXPECT_EQ(paths, 2) << "script and recording know theirs beforehand";
}

TEST(Device, a_profile_fills_what_the_scene_leaves_out) {
  DeviceSpec spec;
  const DeviceFigures plain = figures_of(spec);
  EXPECT_EQ(plain.max_force, 3.3);
  EXPECT_EQ(plain.max_torque, 0.2);
  EXPECT_EQ(plain.encoder_resolution, 0.0);
  EXPECT_FALSE(plain.workspace.is_bounded());
  spec.profile = "premium-1.5";
  const DeviceFigures premium = figures_of(spec);
  EXPECT_EQ(premium.max_force, 8.5);
  EXPECT_EQ(premium.max_torque, 0.0) << "three motors";
  EXPECT_EQ(premium.specification.max_torque.value(), 0.0);
  EXPECT_EQ(premium.mass, 0.075);
  EXPECT_EQ(premium.friction, 0.04);
  EXPECT_EQ(premium.encoder_resolution, 3e-5);
  EXPECT_EQ(premium.workspace.size, Vec3(0.381, 0.267, 0.191));
  EXPECT_NEAR(premium.max_force_slew, 8.5 * 600.0 * M_PI, 1e-9);
  EXPECT_EQ(premium.specification.max_continuous_force.value(), 1.4);
  spec.max_force_n = 2.0;
  spec.max_torque_n_m = 0.1;
  spec.max_force_slew_n_s = 700.0;
  spec.device_mass_kg = 0.1;
  spec.device_friction_n = 0.0;
  spec.encoder_resolution_m = 0.0;
  spec.workspace_radius_m = 0.1;
  const DeviceFigures own = figures_of(spec);
  EXPECT_EQ(own.max_force, 2.0);
  EXPECT_EQ(own.max_force_slew, 700.0);
  EXPECT_EQ(own.max_torque, 0.1);
  EXPECT_EQ(own.mass, 0.1);
  EXPECT_EQ(own.friction, 0.0) << "a zero that is given wins as well";
  EXPECT_EQ(own.encoder_resolution, 0.0);
  EXPECT_TRUE(own.workspace.size.isZero(0.0)) << "the scene's ball in place of the profile's box";
  spec.profile = "premium";
  expect_contains(message_of([&] { figures_of(spec); }),
                  "unknown device profile \"premium\" (did you mean \"premium-1.5\"?)");
}

TEST(Device, pulls_nobody_at_once) {
  for (const auto& entry : device_registry()) {
    DeviceSpec spec;
    spec.type = entry.name;
    const bool is_moved = entry.name == "script" || entry.name == "hand" || entry.name == "recording";
    EXPECT_EQ(figures_of(spec).ramp, is_moved ? 0.0 : 0.2) << entry.name;
    spec.ramp_s = 0.05;
    EXPECT_EQ(figures_of(spec).ramp, 0.05) << entry.name << ": what is given wins";
    spec.ramp_s = 0.0;
    EXPECT_EQ(figures_of(spec).ramp, 0.0) << entry.name;
  }
  DeviceSpec driver;
  driver.type = "a driver of one's own";
  EXPECT_EQ(figures_of(driver).ramp, 0.2);
}

// The pose teleports while a simulated hand holds the device: the requested force jumps from one maximum to
// the other, the force on the hand does not.
TEST(Device, a_jump_of_the_pose_is_no_jump_of_the_force_in_a_hand) {
  int checked = 0;
  for (const char* profile : {"", "omni", "premium-1.5", "omega.3", "haply-pantograph", "haply-inverse3"}) {
    DeviceSpec spec;
    spec.type = "udp";
    spec.profile = profile;
    spec.ramp_s = 0.0;
    const DeviceFigures figures = figures_of(spec);
    const double stiffness = figures.specification.max_stiffness.value_or(1020.0);  // [N/m], 1020: the Omni's
    WrenchLimiter limiter(figures.max_force, figures.max_torque, figures.ramp, figures.max_force_slew,
                          figures.max_torque_slew);
    const double most = std::max(stiffness * 1.0, 150.0 * figures.max_force) * 1e-3;  // a wall hit at 1 m/s
    double before = 0.0;
    for (int i = 0; i <= 100; ++i) {
      const double requested = i < 50 ? -1e6 : 1e6;
      const double force = limiter.limit(1e-3 * i, {Vec3::Zero(), Vec3(0, 0, requested)}, true).force.z();
      EXPECT_LE(std::abs(force - before), most * (1.0 + 1e-9)) << profile << ", tick " << i;
      before = force;
      ++checked;
    }
    EXPECT_NEAR(before, figures.max_force, 1e-3 * figures.max_force) << profile << ": it gets there";
    spec.type = "script";
    EXPECT_GT(figures_of(spec).max_force_slew, figures.max_force_slew) << "nobody's hand";
  }
  EXPECT_EQ(checked, 606);
  DeviceSpec plain;
  plain.type = "udp";
  EXPECT_NEAR(figures_of(plain).max_force_slew, 1020.0, 1e-9);
}

TEST(Device, every_profile_is_a_plausible_desktop_device) {
  int profiles = 0;
  for (const DeviceProfile& one : device_profiles()) {
    DeviceSpec spec;
    spec.profile = one.name;
    const DeviceFigures f = figures_of(spec);
    EXPECT_GE(f.max_force, f.specification.max_continuous_force.value_or(0.0)) << one.name;
    EXPECT_EQ(f.max_torque, 0.0) << one.name << ": three motors at most";
    EXPECT_LT(f.max_force, 50.0) << one.name;
    EXPECT_GE(f.specification.max_stiffness.value(), 300.0) << one.name << ": N/m, not N/mm";
    EXPECT_LT(f.encoder_resolution, 1e-3) << one.name << ": m, not mm";
    EXPECT_LT(f.mass, 1.0) << one.name << ": kg, not g";
    if (one.figures.workspace) {
      EXPECT_LT(f.workspace.size.maxCoeff(), 1.0) << one.name << ": m, not mm";
      EXPECT_GT(f.workspace.size.minCoeff(), 0.05) << one.name;
    }
    ++profiles;
  }
  EXPECT_EQ(profiles, 6);
}

TEST(Device, bad_limits_are_refused) {
  const auto refused = [](auto set, const std::string& part) {
    DeviceSpec spec;
    set(spec);
    expect_contains(message_of([&] { figures_of(spec); }), part);
  };
  refused([](DeviceSpec& s) { s.max_force_n = 0.0; }, "device: max_force_n = 0 must be positive");
  refused([](DeviceSpec& s) { s.max_torque_n_m = NAN; }, "max_torque_n_m = nan");
  refused([](DeviceSpec& s) { s.workspace_radius_m = -1.0; }, "workspace_radius_m = -1");
  refused([](DeviceSpec& s) { s.workspace_margin_m = 0.0; }, "workspace_margin_m = 0");
  refused([](DeviceSpec& s) { s.workspace_size_m = Vec3(1, 0, 1); }, "workspace_size_m = 0");
  refused([](DeviceSpec& s) { s.workspace_center_m.x() = NAN; }, "workspace_center_m must be");
}
