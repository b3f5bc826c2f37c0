// Keys of [device]: keys that a type does not use are rejected, the others are read, and so is every profile.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "loop/registries.h"
#include "palpate/core/error.h"
#include "palpate/device/device.h"
#include "palpate/device/motions.h"
#include "palpate/device/profile.h"
#include "palpate/device/registry.h"
#include "palpate/loop/load.h"

namespace {

using namespace palpate;

/// Returns the keys that a type requires.
std::string needed_by(const std::string& type) {
  if (type == "recording") return "file = \"poses.csv\"\n";
  if (type == "udp") return "port = 4711\n";
  if (type == "plugin") return "library = \"driver.so\"\n";
  if (type == "spacemouse" || type == "gamepad") return "# no key is required\n";
  return "keyframe = [{ time_s = 0.0 }]\n";
}

/// A scene whose tool is held by such a device; [device] begins on line 6, `keys` on line 9.
std::string held_by(const std::string& type, const std::string& keys) {
  return "[scene]\nname = \"tool\"\nduration_s = 0.1\n[tool]\nmass_kg = 0.05\n[device]\ntype = \"" + type +
         "\"\n" + needed_by(type) + keys;
}

std::string refusal(const std::string& text) {
  try {
    loop::parse(text, "s.toml", {});
  } catch (const Error& e) { return e.what(); }
  return "accepted";
}

/// Returns a valid value of the key, as TOML.
std::string value_of(const scene::KeyRow& row) {
  static const std::map<std::string, std::string> own = {{"profile", "\"omni\""},
                                                         {"file", "\"poses.csv\""},
                                                         {"port", "4711"},
                                                         {"library", "\"driver.so\""},
                                                         {"library_options", "\"/dev/ttyUSB0\""},
                                                         {"input", "\"/run/spnav.sock\""},
                                                         {"start_position_m", "[0, 0, 0.1]"},
                                                         {"start_rotation_vector_rad", "[0, 0, 1]"},
                                                         {"keyframe", "[{ time_s = 0.0 }]"},
                                                         {"motion", "[{ amplitude_m = [0, 0, 0.01] }]"},
                                                         {"press", "[{ switch = 1 }]"},
                                                         {"workspace_size_m", "[0.2, 0.1, 0.1]"}};
  if (const auto found = own.find(row.name); found != own.end()) return found->second;
  return row.is_value ? row.fallback : "0.25";
}

std::vector<scene::KeyRow> device_rows() {
  std::vector<scene::KeyRow> rows = scene::key_rows(loop::kinds());
  std::erase_if(rows, [](const scene::KeyRow& row) { return row.table != "device" || row.name == "type"; });
  return rows;
}

TEST(DeviceKeys, AKeyOfAnotherTypeIsRefusedAtItsLocation) {
  EXPECT_EQ(refusal(held_by("script", "arm_mass_kg = 1.0\n")),
            "s.toml:9:15: device: arm_mass_kg does not apply to device type \"script\", which takes "
            "keyframe, motion, press; remove it (used by hand)");
  EXPECT_EQ(refusal(held_by("udp", "file = \"poses.csv\"\n")),
            "s.toml:9:8: device: file does not apply to device type \"udp\", which takes port, address, "
            "time_out_s, wait_s; remove it (used by recording)");
  EXPECT_EQ(refusal(held_by("recording", "keyframe = [{ time_s = 0.0 }]\n")),
            "s.toml:9:12: device: keyframe does not apply to device type \"recording\", which takes file, "
            "time_offset_s, time_scale; remove it (used by script, hand)");
}

TEST(DeviceKeys, EveryTypeTakesItsOwnAndRefusesTheOthers) {
  const std::vector<scene::KeyRow> rows = device_rows();
  int taken = 0, refused = 0, common = 0;
  for (const auto& entry : device::device_registry()) {
    for (const scene::KeyRow& row : rows) {
      if (needed_by(entry.name).starts_with(row.name + " =")) continue;  // already present
      const std::string message = refusal(held_by(entry.name, row.name + " = " + value_of(row) + "\n"));
      const bool listed = std::any_of(entry.keys.begin(), entry.keys.end(),
                                      [&](const PartKey& key) { return key.name == row.name; });
      if (listed || row.users.empty()) {
        EXPECT_EQ(message, "accepted") << entry.name << ", " << row.name;
        ++(listed ? taken : common);
        continue;
      }
      const std::string expected = row.name + " does not apply to device type \"" + entry.name + "\"";
      EXPECT_NE(message.find(expected), std::string::npos)
          << entry.name << ", " << row.name << ": " << message;
      EXPECT_TRUE(message.starts_with("s.toml:9:")) << message;
      ++refused;
    }
  }
  EXPECT_EQ(taken, 2 + 17 + 2 + 3 + 2 + 7 + 7)
      << "motion, press; these and a hand's 15; clock; address, time-out, wait; options, start; rate control";
  EXPECT_EQ(common, 7 * 10) << "profile, four limits, ramp, and four keys of the workspace";
  EXPECT_EQ(refused, 31 + 16 + 31 + 30 + 31 + 27 + 27)
      << "of 34: 3 for scripts, 15 for hands, 3 for recordings, 4 for peers, 2 for drivers, 7 for rate "
         "control";
}

TEST(DeviceKeys, WhatATypeNeedsIsAskedFor) {
  int asked = 0;
  for (const auto& entry : device::device_registry())
    for (const PartKey& key : entry.keys) {
      if (!key.required) continue;
      std::string text = held_by(entry.name, "");
      text.erase(text.size() - needed_by(entry.name).size());
      EXPECT_EQ(refusal(text), "s.toml:6:1: device: " + key.name + " is missing: device type \"" +
                                   entry.name + "\" needs it");
      ++asked;
    }
  EXPECT_EQ(asked, 5) << "one each, none for rate control";
}

TEST(DeviceKeys, EveryProfileIsTakenByEveryType) {
  int taken = 0;
  for (const auto& entry : device::device_registry())
    for (const device::DeviceProfile& one : device::device_profiles()) {
      const std::string text = held_by(entry.name, "profile = \"" + one.name + "\"\n");
      ASSERT_EQ(refusal(text), "accepted") << entry.name << ", " << one.name;
      const scene::Description d = loop::parse(text, "s.toml", {});
      EXPECT_EQ(device::figures_of(*d.device).max_force, one.figures.max_force.value()) << one.name;
      ++taken;
    }
  EXPECT_EQ(taken, 42);
}

TEST(DeviceKeys, UnknownNamesAreRefusedWithSuggestions) {
  EXPECT_EQ(refusal(held_by("script", "profile = \"omnni\"\n")),
            "s.toml:9:11: device: profile = \"omnni\" is not known (did you mean \"omni\"?)");
  EXPECT_EQ(refusal(held_by("script", "profile = \"none\"\n")),
            "s.toml:9:11: device: profile = \"none\" is not known (known: premium-1.5, omni, omega.3, "
            "omega.6, haply-pantograph, "
            "haply-inverse3)");
  EXPECT_EQ(refusal(held_by("hadn", "")),
            "s.toml:7:8: device: type = \"hadn\" is not known (did you mean \"hand\"?)");
  EXPECT_EQ(refusal(held_by("hand", "arm_mass = 1.0\n")),
            "s.toml:9:1: device: unknown key \"arm_mass\" (did you mean \"arm_mass_kg\"?)");
  EXPECT_NE(refusal(held_by("script", "motion = [{ kind = \"strok\", amplitude_m = [0, 0, 1] }]\n"))
                .find("kind = \"strok\" is not known (did you mean \"stroke\"?)"),
            std::string::npos);
}

TEST(DeviceKeys, AMotionTakesTheKeysOfItsKind) {
  const auto with = [](const std::string& keys) {
    return refusal(held_by("script", "motion = [{ amplitude_m = [0, 0, 0.01], " + keys + " }]\n"));
  };
  for (const auto& entry : device::motion_registry()) {
    std::string keys = "kind = \"" + entry.name + "\", duration_s = 0.5";
    for (const PartKey& key : entry.keys)
      if (key.required && key.name != "duration_s")
        keys += ", " + key.name + (key.name == "second_amplitude_m" ? " = [0.01, 0, 0]" : " = 2.0");
    EXPECT_EQ(with(keys), "accepted") << "any motion may end: " << keys;
  }
  EXPECT_EQ(with("kind = \"circle\", second_amplitude_m = [0.01, 0, 0]"), "accepted");
  EXPECT_NE(with("kind = \"tap\", second_amplitude_m = [0.01, 0, 0]")
                .find("second_amplitude_m does not apply to motion \"tap\""),
            std::string::npos)
      << with("kind = \"tap\", second_amplitude_m = [0.01, 0, 0]");
  EXPECT_NE(with("kind = \"stroke\", end_frequency_per_s = 3.0")
                .find("end_frequency_per_s does not apply to motion \"stroke\""),
            std::string::npos);
}

TEST(DeviceKeys, RangesAreChecked) {
  EXPECT_EQ(refusal(held_by("udp", "time_out_s = 0.0\n")),
            "s.toml:9:14: device: time_out_s = 0 must be positive; two ticks, 0.002, are usual");
  EXPECT_NE(refusal(held_by("hand", "delay_s = 2.0\n")).find("delay_s = 2 must lie in [0, 1]"),
            std::string::npos);
  EXPECT_NE(refusal(held_by("hand", "device_mass_kg = 0.0\n")).find("device_mass_kg = 0 must be positive"),
            std::string::npos);
}

}  // namespace
