#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "messages.h"
#include "palpate/core/error.h"
#include "palpate/device/device.h"
#include "palpate/device/registry.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace palpate::device;
using palpate::expectations::expect_contains;
using palpate::expectations::message_of;

namespace {

const std::string kHeader = "time_s,px_m,py_m,pz_m,qw,qx,qy,qz\n";

std::unique_ptr<Device> replay(const TemporaryFolder& folder, const std::string& text) {
  folder.write("r.csv", text);
  DeviceSpec spec;
  spec.type = "recording";
  spec.file = "r.csv";
  return make_device(spec, folder.string());
}

/// x(t) of a function at n + 1 unevenly spaced times in [0, 1].
template <class F>
std::string sampled(F f, int n) {
  std::string out = kHeader;
  for (int i = 0; i <= n; ++i) {
    const double s = static_cast<double>(i) / n, t = s + 0.05 * std::sin(std::numbers::pi * s);
    out += fmt::format("{},{},0,0,1,0,0,0\n", t, f(t));
  }
  return out;
}

}  // namespace

TEST(Recording, goes_through_its_lines_and_rests_outside) {
  const TemporaryFolder folder;
  const auto device =
      replay(folder, kHeader + "1,0.1,0.2,0.3,1,0,0,0\n2,0.4,0,0,0,0,0,1\n4,0,0,0.7,1,0,0,0\n");
  for (const auto& [t, p] : {std::pair{0.0, Vec3(0.1, 0.2, 0.3)},
                             {1.0, Vec3(0.1, 0.2, 0.3)},
                             {2.0, Vec3(0.4, 0, 0)},
                             {4.0, Vec3(0, 0, 0.7)},
                             {9.0, Vec3(0, 0, 0.7)}})
    EXPECT_LT((device->path()(t).pose.translation - p).norm(), 1e-15) << t;
  EXPECT_EQ(device->path()(0.5).twist.linear, Vec3(0, 0, 0));
  EXPECT_EQ(device->path()(4.5).twist.angular, Vec3(0, 0, 0));
  // half a turn about z in the first second, at a constant rate
  EXPECT_NEAR(rotation_vector(device->path()(1.25).pose.rotation).norm(), std::numbers::pi / 4.0, 1e-14);
  EXPECT_NEAR(device->path()(1.5).twist.angular.norm(), std::numbers::pi, 1e-14);
}

// Velocities from a parabola through three samples are exact for a parabola, and so is the cubic between
// them. The vertex of the parabola, more than two lines of the file away, is not among the tested times.
TEST(Recording, a_parabola_comes_back_exactly) {
  const TemporaryFolder folder;
  const auto device = replay(folder, sampled([](double t) { return 0.3 + 0.5 * t + 0.8 * t * t; }, 10));
  int checked = 0;
  for (double t = 0.2; t < 0.85; t += 0.013, ++checked) {
    const HandleSample s = device->sample(t);
    EXPECT_NEAR(s.pose.translation.x(), 0.3 + 0.5 * t + 0.8 * t * t, 1e-14);
    EXPECT_NEAR(s.twist.linear.x(), 0.5 + 1.6 * t, 1e-12);
    EXPECT_NEAR(s.acceleration.linear.x(), 1.6, 1e-10);
  }
  EXPECT_GT(checked, 40);
}

// Convergence is of third order between turning points. At a turning point the motion leaves the interval of
// its two samples, which the handle does not: there it is of second order.
TEST(Recording, converges_with_third_order) {
  const TemporaryFolder folder;
  std::vector<double> errors;
  for (const int n : {20, 40, 80, 160}) {
    const auto device = replay(folder, sampled([](double t) { return std::sin(7.0 * t); }, n));
    double largest = 0.0;
    for (double t = 0.35; t < 0.55; t += 1e-3)  // well between the turning points at 0.22 and 0.67
      largest = std::max(largest, std::abs(device->sample(t).pose.translation.x() - std::sin(7.0 * t)));
    errors.push_back(largest);
  }
  for (std::size_t i = 1; i < errors.size(); ++i) {
    EXPECT_GT(std::log2(errors[i - 1] / errors[i]), 2.7);
    EXPECT_LT(std::log2(errors[i - 1] / errors[i]), 4.2);
  }
}

// Between two samples each component stays between their values, however uneven the samples are (after a
// pause, in a jump, at a turning point); the path passes through every sample with continuous velocity.
TEST(Recording, between_two_lines_the_handle_stays_between_them) {
  const TemporaryFolder folder;
  std::mt19937 rng(20261128);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::string text = kHeader;
  std::vector<double> times = {0.0};
  std::vector<Vec3> lines;
  for (int i = 0; i < 60; ++i) {
    const double x = lines.empty() || i % 5 ? 0.1 * uniform(rng) : lines.back().x();  // some at rest
    lines.emplace_back(x, 0.01 * i, 0.1 * std::pow(uniform(rng), 5));
    text += fmt::format("{},{},{},{},1,0,0,0\n", times.back(), x, lines.back().y(), lines.back().z());
    times.push_back(times.back() + std::pow(10.0, 1.5 * uniform(rng) - 1.5));
  }
  const auto path = replay(folder, text)->path();
  long checked = 0;
  for (std::size_t i = 0; i + 1 < lines.size(); ++i)
    for (int k = 1; k < 50; ++k, ++checked) {
      const double h = times[i + 1] - times[i];
      const HandleSample sample = path(times[i] + 0.02 * k * h);
      const Vec3 p = sample.pose.translation, way = lines[i + 1] - lines[i];
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(h * sample.twist.linear[axis] * way[axis], -1e-12 * way.squaredNorm())
            << i << ": turns back";
        EXPECT_GE(p[axis], std::min(lines[i][axis], lines[i + 1][axis])) << i;
        EXPECT_LE(p[axis], std::max(lines[i][axis], lines[i + 1][axis])) << i;
      }
    }
  EXPECT_EQ(checked, 59 * 49);
  for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
    const double e = 1e-9 * std::min(times[i] - times[i - 1], times[i + 1] - times[i]);
    const Vec3 before = path(times[i] - e).twist.linear, after = path(times[i] + e).twist.linear;
    EXPECT_LT((before - after).norm(), 1e-6 * (1.0 + after.norm())) << i;
  }
}

// A pause that the recorder left out: samples every 10 ms, then none for a second, then samples from nearby.
TEST(Recording, a_pause_is_no_swing) {
  const TemporaryFolder folder;
  const auto path =
      replay(folder, kHeader +
                         "0,0,0,0.085,1,0,0,0\n0.01,0,0,0.0845,1,0,0,0\n0.02,0,0,0.084,1,0,0,0\n"
                         "1.02,0,0,0.0839,1,0,0,0\n1.03,0,0,0.0834,1,0,0,0\n")
          ->path();
  for (double t = 0.02; t < 1.02; t += 1e-3) {
    EXPECT_LE(path(t).pose.translation.z(), 0.084) << t;
    EXPECT_GE(path(t).pose.translation.z(), 0.0839) << t;
  }
}

TEST(Recording, twist_and_acceleration_are_the_derivatives) {
  const TemporaryFolder folder;
  const auto device =
      replay(folder, kHeader +
                         "0,0,0,0,1,0,0,0\n0.3,0.02,0.1,0,0.8,0.6,0,0\n0.7,-0.05,0.1,0.2,0.6,0,"
                         "0.8,0\n1,0.05,0,0,1,0,0,0\n");
  const auto path = device->path();
  for (const double t : {0.11, 0.45, 0.6, 0.83}) {
    const double h = 1e-4;
    const HandleSample a = path(t - h), o = path(t), b = path(t + h);
    const Vec6 rate = pose_difference(a.pose, b.pose) / (2 * h);
    EXPECT_LT((rate.head<3>() - o.twist.angular).norm(), 1e-9) << t;
    EXPECT_LT((rate.tail<3>() - o.twist.linear).norm(), 1e-6) << t;
    EXPECT_LT(((b.twist.linear - a.twist.linear) / (2 * h) - o.acceleration.linear).norm(), 1e-9) << t;
    EXPECT_GT(o.acceleration.linear.norm(), 1e-3);
  }
}

TEST(Recording, takes_the_force_file_of_a_run) {
  const TemporaryFolder folder;
  const auto device =
      replay(folder,
             "time_s,handle_x_m,handle_y_m,handle_z_m,handle_rotation_x_rad,handle_rotation_y_rad,"
             "handle_rotation_z_rad,tool_x_m,limited\n0.001,1,2,3,0,0.5,0,7,0\n0.002,1,2,4,0,0.5,0,7,1\n");
  EXPECT_EQ(device->sample(0.001).pose.translation, Vec3(1, 2, 3));
  EXPECT_NEAR(rotation_vector(device->rotation()).y(), 0.5, 1e-15);
  EXPECT_EQ(device->sample(0.01).pose.translation, Vec3(1, 2, 4));
}

TEST(Recording, columns_may_come_in_any_order) {
  const TemporaryFolder folder;
  const auto device = replay(folder, "note,qz,qy,qx,qw,pz_m,py_m,px_m,time_s\r\n0,0,0,0,1,3,2,1,0\r\n\n");
  EXPECT_EQ(device->sample(0.0).pose.translation, Vec3(1, 2, 3));
}

TEST(Recording, switches_are_those_of_the_line_before) {
  const TemporaryFolder folder;
  const auto device = replay(folder,
                             "time_s,switches,px_m,py_m,pz_m,qw,qx,qy,qz\n0,0,0,0,0,1,0,0,0\n"
                             "0.5,5,0.1,0,0,1,0,0,0\n1,2,0,0,0,1,0,0,0\n");
  EXPECT_EQ(device->sample(0.4).switches, 0u);
  EXPECT_EQ(device->sample(0.5).switches, 5u);
  EXPECT_EQ(device->sample(0.9).switches, 5u);
  EXPECT_EQ(device->switches(), 5u);
  EXPECT_NEAR(device->position().x(), 0.05, 0.05) << "the columns are told apart";
  EXPECT_EQ(device->sample(2.0).switches, 2u);
  EXPECT_EQ(replay(folder, kHeader + "0,0,0,0,1,0,0,0\n")->sample(1.0).switches, 0u);
}

// Dialects that programs of the field write: each file holds the same two samples.
TEST(Recording, dialects_read_alike) {
  const TemporaryFolder folder;
  const std::string rows = "0,0.1,0.2,0.3,1,0,0,0\n1,0.1,0.2,0.4,1,0,0,0\n";
  int checked = 0;
  for (const std::string& text :
       {kHeader + rows, "\xef\xbb\xbf" + kHeader + rows, kHeader + rows + "\r\n  \n\n,,,,,,,\n",
        std::string("time_s,px_m,py_m,pz_m,qw,qx,qy,qz\r\n+0.0e+00,+1.0e-01,+2.0E-01,+3e-1,+1,0,0,0\r\n"
                    "1,.1,.2,.4,1.,0,0,0\r\n\r\n"),
        std::string("time_s;px_m;py_m;pz_m;qw;qx;qy;qz\n0;0,1;0,2;0,3;1;0;0;0\n1,0;0,1;0,2;0,4;1,0;0;0;0\n"),
        std::string("time_s\tpx_m\tpy_m\tpz_m\tqw\tqx\tqy\tqz\n0\t0.1\t0.2\t0.3\t1\t0\t0\t0\n"
                    "1\t0.1\t0.2\t0.4\t1\t0\t0\t0"),
        std::string("# Time_S, PX_m ,\"py_m\", pz_m,QW,qx,qy,qz\n0, 0.1, 0.2, 0.3, 1, 0, 0, 0,\n"
                    "1,\"0.1\",0.2,0.4,1,0,0,0\n"),
        std::string("sep=;\r\ntime_s;px_m;py_m;pz_m;qw;qx;qy;qz\r\n0;0.1;0.2;0.3;1;0;0;0\r\n"
                    "1;0.1;0.2;0.4;1;0;0;0\r\n")}) {
    const auto path = replay(folder, text)->path();
    EXPECT_EQ(path(0.0).pose.translation, Vec3(0.1, 0.2, 0.3)) << text;
    EXPECT_EQ(path(1.0).pose.translation, Vec3(0.1, 0.2, 0.4)) << text;
    ++checked;
  }
  EXPECT_EQ(checked, 8);
}

TEST(Recording, times_are_scaled_then_shifted) {
  const TemporaryFolder folder;
  folder.write("r.csv", kHeader + "1700000000000,0,0,0,1,0,0,0\n1700000000500,1,0,0,1,0,0,0\n");
  DeviceSpec spec;
  spec.type = "recording";
  spec.file = "r.csv";
  spec.time_scale = 1e-3;
  spec.time_offset_s = -1.7e9;
  const auto device = make_device(spec, folder.string());
  EXPECT_NEAR(device->path()(0.25).pose.translation.x(), 0.5, 1e-6);
  EXPECT_NEAR(device->path()(0.25).twist.linear.x(), 2.0, 1e-6);
  ASSERT_TRUE(device->recorded());
  EXPECT_NEAR(device->recorded()->last, 0.5, 1e-6);
  spec.time_scale = 0.0;
  expect_contains(message_of([&] { make_device(spec, folder.string()); }), "time_scale = 0 must be positive");
}

TEST(Recording, malformed_files_are_refused_with_line_and_column) {
  const TemporaryFolder folder;
  int checked = 0;
  const auto refused = [&](const std::string& text, const std::string& part) {
    expect_contains(message_of([&] { replay(folder, text); }), (folder / "r.csv").string() + part);
    ++checked;
  };
  refused("", ":1: the file is empty");
  refused("time_s,px_m,py_m,pz_m,qw,qx,qy\n", ":1: no column \"qz\"");
  refused(kHeader, ": no poses follow");
  refused(kHeader + "0,0,0,0,1,0,0,0\n1,0,0,x,1,0,0,0\n",
          ":3: column \"pz_m\": \"x\" is not a finite number");
  refused(kHeader + "0,0,nan,0,1,0,0,0\n", ":2: column \"py_m\": \"nan\" is not a finite number");
  refused(kHeader + "0,0,0,0,1,0,0,0 1\n", ":2: column \"qz\": \"0 1\" is not a finite number");
  refused(kHeader + "0,0,0,0,1,0,0\n", ":2: 7 cells, but 8 column names");
  refused(kHeader + "0,0,0,0,1,0,0,0\n0,0,0,0,1,0,0,0\n", ":3: column \"time_s\": 0 must be greater than 0");
  refused(kHeader + "0,0,0,0,0.5,0,0,0\n",
          ":2: column \"qw\": the length of the quaternion is 0.5; it must be 1");
  refused("switches," + kHeader + "-1,0,0,0,0,1,0,0,0\n", ":2: switches = -1 must be a whole number");
  refused("switches," + kHeader + "1.5,0,0,0,0,1,0,0,0\n", ":2: switches = 1.5 must be a whole number");
  refused("0,0,0,0,1,0,0,0\n", ":1: the first line has numbers instead of column names");
  refused("time_s px_m py_m pz_m qw qx qy qz\n0 0 0 0 1 0 0 0\n",
          ":1: the columns are not separated by commas");
  refused(kHeader + "0,0,\"0,5\",0.5,1,0,0,0\n",
          ":2: column \"pz_m\": \"0.5\" has a decimal point, but \"0,5\" before it has a decimal comma");
  refused(std::string("\xff\xfet\0i\0", 6), ":1: the file is in UTF-16");
  EXPECT_EQ(checked, 15);
  DeviceSpec spec;
  spec.type = "recording";
  expect_contains(message_of([&] { make_device(spec); }), "device: file is missing");
  spec.file = "none.csv";
  expect_contains(message_of([&] { make_device(spec, folder.string()); }), "cannot read the recording");
}
