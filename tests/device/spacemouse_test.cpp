// The SpaceMouse, with a stand-in of its daemon on a Unix socket.
#include "device/spacemouse.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "messages.h"
#include "palpate/device/registry.h"
#include "stand_ins.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace palpate::device;
using palpate::expectations::expect_contains;
using palpate::expectations::message_of;

namespace {

struct Connected {
  TemporaryFolder folder;
  SpacemouseServer server{(folder / "spnav.sock").string()};
  std::unique_ptr<Device> device;
  Connected() {
    DeviceSpec spec;
    spec.type = "spacemouse";
    spec.input = (folder / "spnav.sock").string();
    spec.max_speed_m_s = 0.1;
    spec.max_turn_rate_rad_s = 2.0;
    spec.dead_zone = 0.0;
    device = make_device(spec);
    device->open();
  }
};

}  // namespace

// The axes of the daemon are x right, y up, z away from the user; those of palpate x right, y away, z up.
TEST(Spacemouse, full_deflections_give_full_speed_along_each_axis) {
  const std::array<Vec3, 3> axis = {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, 1, 0)};
  for (std::size_t i = 0; i < 3; ++i) {
    Connected c;
    std::array<std::int32_t, 8> packet{};
    packet[1 + i] = 350;
    packet[4 + i] = -175;
    packet[7] = 8;
    c.server.send(packet);
    const HandleSample s = c.device->sample(0.0);
    EXPECT_LT((s.twist.linear - 0.1 * axis[i]).norm(), 1e-14) << i;
    EXPECT_LT((s.twist.angular + 1.0 * axis[i]).norm(), 1e-14) << i;
    const HandleSample later = c.device->sample(0.5);
    EXPECT_LT((later.pose.translation - 0.05 * axis[i]).norm(), 1e-14) << i;
    EXPECT_TRUE(later.valid);
  }
}

TEST(Spacemouse, holds_its_velocity_until_the_daemon_sends_another) {
  Connected c;
  c.server.send({0, 350, 0, 0, 0, 0, 0, 8});
  c.device->sample(0.0);
  c.server.send({0, 0, 0, 0, 0, 0, 0, 8});
  EXPECT_NEAR(c.device->sample(1.0).pose.translation.x(), 0.1, 1e-14);
  EXPECT_NEAR(c.device->sample(2.0).pose.translation.x(), 0.1, 1e-14);
  EXPECT_EQ(c.server.received(), "") << "version 0 of the protocol: the client sends nothing";
}

TEST(Spacemouse, buttons_are_switches) {
  Connected c;
  c.server.send({1, 0, 1, 0, 0, 0, 0, 0});
  c.server.send({1, 3, 1, 0, 0, 0, 0, 0});
  EXPECT_EQ(c.device->sample(0.0).switches, 0b1001u);
  c.server.send({2, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(c.device->sample(0.1).switches, 0b1000u);
  c.server.send({1, 32, 1, 0, 0, 0, 0, 0});
  c.server.send({1, -1, 1, 0, 0, 0, 0, 0});
  c.server.send({6, 1, 1, 0, 0, 0, 0, 0});  // an event of later versions
  EXPECT_EQ(c.device->sample(0.2).switches, 0b1000u);
  const auto counters = c.device->counters();
  EXPECT_EQ(counters[1], (std::pair<std::string, long long>("button_packets", 3)));
  EXPECT_EQ(counters[2], (std::pair<std::string, long long>("other_packets", 3)));
}

TEST(Spacemouse, packets_may_arrive_in_pieces) {
  Connected c;
  const std::array<std::int32_t, 8> packet = {0, 350, 0, 0, 0, 0, 0, 8};
  c.server.send_bytes(packet.data(), 5);
  EXPECT_EQ(c.device->sample(0.0).twist.linear.x(), 0.0);
  c.server.send_bytes(reinterpret_cast<const char*>(packet.data()) + 5, sizeof packet - 5);
  EXPECT_NEAR(c.device->sample(0.1).twist.linear.x(), 0.1, 1e-14);
}

TEST(Spacemouse, a_daemon_that_ends_stops_the_handle_and_makes_samples_invalid) {
  Connected c;
  c.server.send({0, 350, 0, 0, 0, 0, 0, 8});
  c.server.send({1, 0, 1, 0, 0, 0, 0, 0});
  EXPECT_TRUE(c.device->sample(0.0).valid);
  c.server.hang_up();
  const HandleSample s = c.device->sample(0.1);
  EXPECT_FALSE(s.valid);
  EXPECT_EQ(s.twist.linear, Vec3(0, 0, 0));
  EXPECT_EQ(s.switches, 0u);
  EXPECT_EQ(c.device->counters().back(), (std::pair<std::string, long long>("connections_lost", 1)));
  c.device->feedback(0.1, {});
}

TEST(Spacemouse, without_a_daemon_it_names_the_socket) {
  const TemporaryFolder folder;
  DeviceSpec spec;
  spec.type = "spacemouse";
  spec.input = (folder / "no.sock").string();
  const auto device = make_device(spec);
  expect_contains(message_of([&] { device->open(); }), "device: no daemon of a SpaceMouse answers at " +
                                                           spec.input + " (No such file or directory)");
  EXPECT_FALSE(device->is_open());
  EXPECT_TRUE(device->is_live());
  ::unsetenv("SPNAV_SOCKET");
  spec.input.clear();
  EXPECT_EQ(spacemouse_socket(spec), "/run/spnav.sock");
  ::setenv("SPNAV_SOCKET", "/tmp/other.sock", 1);
  EXPECT_EQ(spacemouse_socket(spec), "/tmp/other.sock");
  ::unsetenv("SPNAV_SOCKET");
  spec.input = std::string(200, 'x');
  expect_contains(message_of([&] { make_device(spec)->open(); }), "is too long for a socket");
}
