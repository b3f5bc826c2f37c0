#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "palpate/device/device.h"
#include "palpate/device/keyframes.h"
#include "palpate/device/registry.h"

using namespace palpate;
using namespace palpate::device;

namespace {

KeyframeSpec key(double t, const Vec3& p, const Vec3& r = Vec3::Zero(),
                 Interpolation way = Interpolation::kMinimumJerk) {
  return {t, p, r, way};
}

std::vector<KeyframeSpec> random_path(Interpolation way) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<KeyframeSpec> keys;
  for (int i = 0; i < 5; ++i)
    keys.push_back(key(0.3 * i + 0.1, Vec3(uniform(rng), uniform(rng), uniform(rng)),
                       0.9 * Vec3(uniform(rng), uniform(rng), uniform(rng)), way));
  return keys;
}

std::string message(const std::vector<KeyframeSpec>& keys) {
  try {
    check_keyframes(keys, "device");
  } catch (const Error& e) { return e.what(); }
  return "";
}

/// Largest error of the central differences of pose against twist, and of twist against acceleration, at step
/// h.
double derivative_error(const std::vector<KeyframeSpec>& keys, double t, double h) {
  const HandleSample a = sample_keyframes(keys, t - h), m = sample_keyframes(keys, t),
                     b = sample_keyframes(keys, t + h);
  Vec6 twist, acceleration;
  twist << m.twist.angular, m.twist.linear;
  acceleration << m.acceleration.angular, m.acceleration.linear;
  Vec6 twist_difference;
  twist_difference << b.twist.angular - a.twist.angular, b.twist.linear - a.twist.linear;
  return (pose_difference(a.pose, b.pose) / (2 * h) - twist).norm() +
         (twist_difference / (2 * h) - acceleration).norm();
}

}  // namespace

TEST(Keyframes, rests_before_and_after) {
  const auto keys = random_path(Interpolation::kMinimumJerk);
  for (double t : {-5.0, 0.0, 0.1, 1.3, 99.0}) {
    const HandleSample s = sample_keyframes(keys, t);
    const KeyframeSpec& k = t < 1.0 ? keys.front() : keys.back();
    EXPECT_EQ((s.pose.translation - k.position_m).norm(), 0.0);
    EXPECT_NEAR(rotation_vector(s.pose.rotation * quaternion_of(k.rotation_vector_rad).conjugate()).norm(),
                0.0, 1e-15);
    EXPECT_EQ(s.twist.linear.norm() + s.twist.angular.norm() + s.acceleration.linear.norm() +
                  s.acceleration.angular.norm(),
              0.0);
    EXPECT_TRUE(s.valid);
  }
}

TEST(Keyframes, minimum_jerk_values_of_the_quintic) {
  const std::vector<KeyframeSpec> keys = {key(1.0, Vec3::Zero()), key(3.0, Vec3(2, 0, 0), Vec3(0, 0, 1.0))};
  // At a quarter: s = 10/64 - 15/256 + 6/1024 = 106/1024, s' = 30 (1/16)(9/16)/T, s'' = 60
  // (1/4)(3/4)(1/2)/T^2.
  const HandleSample s = sample_keyframes(keys, 1.5);
  EXPECT_NEAR(s.pose.translation.x(), 2 * 106.0 / 1024.0, 1e-15);
  EXPECT_NEAR(s.twist.linear.x(), 2 * 30.0 * 9.0 / 256.0 / 2.0, 1e-14);
  EXPECT_NEAR(s.acceleration.linear.x(), 2 * 60.0 * 3.0 / 32.0 / 4.0, 1e-14);
  EXPECT_NEAR(rotation_vector(s.pose.rotation).z(), 106.0 / 1024.0, 1e-15);
  EXPECT_NEAR(s.twist.angular.z(), 30.0 * 9.0 / 256.0 / 2.0, 1e-14);
}

TEST(Keyframes, twist_and_acceleration_are_the_derivatives) {
  for (const auto way : {Interpolation::kMinimumJerk, Interpolation::kLinear}) {
    const auto keys = random_path(way);
    int checked = 0;
    for (double t : {0.17, 0.33, 0.52, 0.86, 1.19}) {
      if (way == Interpolation::kLinear) {
        // no truncation error: constant rate about a fixed axis
        EXPECT_LT(derivative_error(keys, t, 1e-3), 1e-11);
      } else {
        std::vector<double> e;
        for (double h = 0.016; h > 4e-4; h /= 2) e.push_back(derivative_error(keys, t, h));
        for (std::size_t i = 1; i < e.size(); ++i) EXPECT_NEAR(std::log2(e[i - 1] / e[i]), 2.0, 0.1) << t;
      }
      ++checked;
    }
    EXPECT_EQ(checked, 5);
  }
}

TEST(Keyframes, minimum_jerk_is_at_rest_and_c2_at_keyframes) {
  const auto keys = random_path(Interpolation::kMinimumJerk);
  for (std::size_t i = 0; i < keys.size(); ++i)
    for (double side : {-1e-9, 0.0, 1e-9}) {
      const HandleSample s = sample_keyframes(keys, keys[i].time_s + side);
      EXPECT_LT((s.pose.translation - keys[i].position_m).norm(), 1e-12);
      EXPECT_LT(
          rotation_vector(s.pose.rotation * quaternion_of(keys[i].rotation_vector_rad).conjugate()).norm(),
          1e-12);
      EXPECT_LT(s.twist.linear.norm() + s.twist.angular.norm(), 1e-12);
      EXPECT_LT(s.acceleration.linear.norm() + s.acceleration.angular.norm(), 1e-4);
    }
}

TEST(Keyframes, step_jumps_at_its_own_time) {
  const std::vector<KeyframeSpec> keys = {key(0.0, Vec3::Zero()),
                                          key(0.5, Vec3(1, 2, 3), Vec3::Zero(), Interpolation::kStep),
                                          key(1.0, Vec3(0, 0, 9), Vec3::Zero(), Interpolation::kStep)};
  EXPECT_EQ(sample_keyframes(keys, std::nextafter(0.5, 0.0)).pose.translation, Vec3(0, 0, 0));
  EXPECT_EQ(sample_keyframes(keys, 0.5).pose.translation, Vec3(1, 2, 3));
  EXPECT_EQ(sample_keyframes(keys, 0.7).twist.linear, Vec3(0, 0, 0));
  EXPECT_EQ(sample_keyframes(keys, 1.0).pose.translation, Vec3(0, 0, 9));
}

TEST(Keyframes, bad_paths_are_refused) {
  const Vec3 o = Vec3::Zero();
  EXPECT_NE(message({}).find("device: no keyframes; give at least one"), std::string::npos);
  EXPECT_NE(message({key(0, o), key(0, o)})
                .find("keyframes[1]: time_s = 0 must be greater than that of the previous keyframe (0)"),
            std::string::npos);
  EXPECT_NE(message({key(0, o), key(1, Vec3(NAN, 0, 0))})
                .find("keyframes[1]: time, position and rotation must be finite"),
            std::string::npos);
  EXPECT_NE(message({key(0, o), key(1, o, Vec3(0, 3.2, 0))}).find("more than half a turn"),
            std::string::npos);
  EXPECT_EQ(message({key(0, o), key(1, o, Vec3(0, std::numbers::pi, 0))}), "");
  EXPECT_THROW(sample_keyframes({}, 0.0), Error);
  DeviceSpec spec;
  spec.type = "scripd";
  EXPECT_THROW(make_device(spec), Error);
}
