// Drivers in shared objects (tests/device/drivers): sound ones, and each fault that a driver may have.
#include "palpate/device/plugin.h"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

#include "messages.h"
#include "palpate/device/profile.h"
#include "palpate/device/registry.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace palpate::device;
using palpate::expectations::expect_contains;
using palpate::expectations::message_of;

namespace {

DeviceSpec spec_of(const std::string& library, const std::string& options = "") {
  DeviceSpec spec;
  spec.type = "plugin";
  spec.library = library;
  spec.library_options = options;
  return spec;
}

std::unique_ptr<Device> driver(const std::string& options, const std::string& library = "driver.so") {
  return make_device(spec_of(library, options), PALPATE_DRIVERS);
}

std::string refusal(const std::string& library, const std::string& options = "") {
  return message_of([&] { driver(options, library); });
}

long long counter(const Device& device, const std::string& name) {
  for (const auto& [key, value] : device.counters())
    if (key == name) return value;
  ADD_FAILURE() << "no counter " << name;
  return -1;
}

void skip_with_sanitizers() {
#ifdef PALPATE_SANITIZED
  GTEST_SKIP() << "sanitizers handle fatal signals";
#endif
}

}  // namespace

TEST(Plugin, samples_and_receives_forces) {
  const auto device = driver("");
  EXPECT_EQ(device->specification().name, "test driver");
  EXPECT_FALSE(device->is_live());
  const HandleSample s = device->sample(0.5);
  EXPECT_TRUE(s.valid);
  EXPECT_EQ(s.pose.translation, Vec3(0.05, 0, 1)) << "open once";
  EXPECT_EQ(s.twist.linear, Vec3(0.1, 0, 0));
  EXPECT_EQ(s.twist.angular, Vec3(0, 0, 0.2));
  EXPECT_EQ(s.switches, 5u);
  device->feedback(0.5, {Vec3(9, 9, 9), Vec3(0.25, 1, 2)});
  EXPECT_EQ(device->sample(0.6).pose.translation.y(), 0.25) << "the force reached the driver";
  device->close();
  EXPECT_EQ(device->sample(0.7).pose.translation.z(), 1) << "closed once, and open again";
  EXPECT_EQ(counter(*device, "poses_accepted"), 3);
}

// x = t/10 without turning: the low pass of 100 1/s has the velocity to 1e-9 after 50 ms.
TEST(Plugin, velocities_that_a_driver_does_not_state_follow_from_its_poses) {
  const auto device = driver("no velocity");
  EXPECT_EQ(device->sample(0.0).twist.linear, Vec3::Zero().eval()) << "no motion is known yet";
  HandleSample s = device->sample(1e-3);
  const double share = 1.0 - std::exp(-2.0 * M_PI * 100.0 * 1e-3);
  EXPECT_NEAR(s.twist.linear.x(), 0.1 * share, 1e-12);
  EXPECT_EQ(device->sample(1e-3).twist.linear, s.twist.linear) << "a repeated time changes nothing";
  for (int i = 2; i <= 50; ++i) s = device->sample(1e-3 * i);
  EXPECT_NEAR(s.twist.linear.x(), 0.1, 1e-9);
  EXPECT_EQ(s.twist.angular, Vec3::Zero().eval()) << "the numbers of the driver are not used";
  EXPECT_EQ(driver("")->sample(0.5).twist.angular, Vec3(0, 0, 0.2)) << "other drivers' are";
}

TEST(Plugin, its_stated_figures_take_the_place_of_a_profile) {
  const auto device = driver("stated");
  const DeviceFigures figures = figures_of(with_reported_limits(spec_of("driver.so"), *device));
  EXPECT_EQ(figures.max_force, 8.0);
  EXPECT_EQ(figures.max_torque, 0.0) << "negative: no motors for it";
  EXPECT_EQ(figures.workspace.size, Vec3(0.1, 0.2, 0.30000000000000004));
  EXPECT_NEAR(figures.max_force_slew, 4000.0, 1e-9) << "the stiffest wall, hit at 1 m/s";
  DeviceSpec limited = spec_of("driver.so");
  limited.max_force_n = 2.0;
  EXPECT_EQ(figures_of(with_reported_limits(limited, *device)).max_force, 2.0) << "the scene has precedence";
  limited.max_force_n.reset();
  limited.profile = "omni";
  EXPECT_EQ(figures_of(with_reported_limits(limited, *device)).max_force, 3.3) << "so has a profile";
  EXPECT_EQ(figures_of(with_reported_limits(spec_of("driver.so"), *driver(""))).max_force, 3.3);
}

TEST(Plugin, a_person_at_the_device_needs_real_time) { EXPECT_TRUE(driver("live")->is_live()); }

TEST(Plugin, unusable_poses_are_invalid_and_the_last_good_one_is_repeated) {
  int checked = 0;
  for (const char* options : {"nan", "no rotation", "silent"}) {
    const auto device = driver(options);
    const HandleSample first = device->sample(0.0), then = device->sample(0.4);
    EXPECT_FALSE(then.valid) << options;
    EXPECT_TRUE(then.pose.translation.allFinite()) << options;
    EXPECT_EQ(then.pose.translation, first.pose.translation) << options;
    EXPECT_EQ(then.pose.rotation.norm(), 1.0) << options;
    const long long not_finite = counter(*device, "poses_not_finite");
    EXPECT_EQ(not_finite, options == std::string("nan") ? 1 : options[0] == 'n' ? 2 : 0) << options;
    ++checked;
  }
  EXPECT_EQ(checked, 3);
  const auto bounded = driver("");
  PoseBounds bounds;
  bounds.radius = 1.5;
  bounded->bound(bounds);
  EXPECT_TRUE(bounded->sample(1.0).valid);
  EXPECT_FALSE(bounded->sample(1e6).valid);
  EXPECT_EQ(counter(*bounded, "poses_out_of_bounds"), 1);
}

TEST(Plugin, texts_of_the_driver_reach_the_user_in_one_place) {
  const auto closed = driver("no device");
  const std::string message = message_of([&] { closed->open(); });
  expect_contains(message, "device: device driver \"test driver\" (");
  expect_contains(message, "driver.so): open: no device on port 7");
  EXPECT_EQ(message.find('\033'), std::string::npos) << "nothing for the terminal";
  EXPECT_FALSE(closed->is_open());
  const auto unplugged = driver("unplugged");
  unplugged->open();
  unplugged->sample(0.0);
  expect_contains(message_of([&] { unplugged->sample(0.1); }), "driver.so): sample: unplugged");
  const auto throws = driver("throw", "throwing_driver.so");
  expect_contains(message_of([&] { throws->open(); }), "throwing_driver.so): open: exception: bus error 3");
  expect_contains(refusal("driver.so", "no specification"), "specification: firmware 1.2 is too old");
}

TEST(Plugin, a_driver_without_motors_is_fine) {
  const auto device = driver("", "throwing_driver.so");
  EXPECT_TRUE(device->sample(0.0).valid);
  device->feedback(0.0, {Vec3(1, 2, 3), Vec3(4, 5, 6)});
}

TEST(Plugin, libraries_that_do_not_fit_are_refused) {
  const TemporaryFolder folder;
  const std::string text = folder.write("text.so", "no shared object").string();
  expect_contains(refusal(""), "device: library is missing");
  expect_contains(refusal("./nowhere.so"),
                  "device: library = \"./nowhere.so\" does not exist: there is no file");
  expect_contains(refusal("libnowhere.so"), "device: library = \"libnowhere.so\" cannot be loaded: ");
  expect_contains(refusal("libnowhere.so"), "it is not in the scene's folder " PALPATE_DRIVERS);
  expect_contains(refusal(text), "cannot be loaded: ");
  expect_contains(refusal("driver_without_symbol.so"), "exports no \"palpate_device_plugin\"");
  expect_contains(refusal("driver_of_version_7.so"),
                  "has version 7 of the driver interface, and this palpate version 1; build it against");
  expect_contains(refusal("driver_with_other_sizes.so"), "sample_size = 100 bytes, but this palpate has 112");
  expect_contains(refusal("driver_without_sample.so"), "the table has no function \"sample\"");
  expect_contains(refusal("driver.so", "nameless"), "has no name of at most 63 characters");
  expect_contains(refusal("driver.so", "long name"), "has no name of at most 63 characters");
  expect_contains(refusal("driver.so", "bad figure"),
                  "max_force_n = -2 of its specification must be a number");
}

TEST(PluginDeath, a_crash_names_the_driver_and_its_function) {
  skip_with_sanitizers();
  if (IsSkipped()) return;
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto run = [](const std::string& options) {
    const auto device = driver(options);
    device->sample(0.0);
    device->sample(0.1);
  };
  EXPECT_EXIT(
      run("crash"), testing::KilledBySignal(SIGSEGV),
      "palpate: error: device driver \"test driver\" \\(.*driver.so\\): SIGSEGV in sample; the process");
  EXPECT_EXIT(run("abort"), testing::KilledBySignal(SIGABRT), "driver.so\\): SIGABRT in sample; ");
  EXPECT_EXIT(run("crash thread"), testing::KilledBySignal(SIGSEGV),
              "driver.so\\): SIGSEGV in its own thread");
}

TEST(PluginDeath, a_crash_elsewhere_is_not_blamed_on_the_driver) {
  skip_with_sanitizers();
  if (IsSkipped()) return;
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto run = [] {
    const auto device = driver("");
    device->sample(0.0);
    std::fprintf(stderr, "[");
    std::raise(SIGSEGV);
  };
  EXPECT_EXIT(run(), testing::KilledBySignal(SIGSEGV), "\\[$");
}

TEST(Plugin, handlers_are_restored_with_the_last_driver) {
  struct sigaction before {
  }, with{}, after{};
  ::sigaction(SIGBUS, nullptr, &before);
  auto first = driver(""), second = driver("");
  first.reset();
  ::sigaction(SIGBUS, nullptr, &with);
  EXPECT_NE(with.sa_sigaction, before.sa_sigaction);
  second.reset();
  ::sigaction(SIGBUS, nullptr, &after);
  EXPECT_EQ(after.sa_sigaction, before.sa_sigaction);
}

// The example: m z'' = k (target - z) - b z' + f about a resting target.
TEST(Plugin, the_example_yields_to_the_force_by_its_stiffness) {
  const auto device = driver("0.5", "example_driver.so");
  EXPECT_EQ(device->specification().name, "one-axis device");
  EXPECT_EQ(device->sample(0.0).pose.translation, Vec3(0, 0, 0.5));
  for (int i = 1; i <= 4000; ++i) {
    device->sample(1e-3 * i);
    device->feedback(1e-3 * i, {Vec3::Zero(), Vec3(0, 0, 2.0)});
  }
  // sin(8 pi) = 0: the target is at 0.5 m; the force shifts by 2 N / 500 N/m, the motion lags by b w a / k.
  const double lag = 5.0 * 2.0 * M_PI * 0.01 / 500.0;
  EXPECT_NEAR(device->sample(4.0).pose.translation.z(), 0.5 + 0.004 + lag, 2e-5);
  expect_contains(message_of([] { driver("high", "example_driver.so")->open(); }),
                  "open: options must be the height of the handle [m]");
}
