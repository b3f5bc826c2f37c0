// A UDP device on the loopback network, with its peer in the test.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "messages.h"
#include "palpate/core/error.h"
#include "palpate/device/registry.h"
#include "palpate/device/udp.h"

using namespace palpate;
using namespace palpate::device;
using palpate::expectations::expect_contains;
using palpate::expectations::message_of;

namespace {

class Peer {
 public:
  explicit Peer(int port) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to_.sin_port = htons(static_cast<std::uint16_t>(port));
    EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&to_), sizeof to_), 0);
  }
  ~Peer() { ::close(socket_); }
  /// Sends a packet; loopback delivers it within the call.
  template <class Bytes>
  void send(const Bytes& bytes) {
    EXPECT_EQ(::send(socket_, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  }
  /// Returns every wrench received so far.
  std::vector<WrenchPacket> wrenches() {
    std::vector<WrenchPacket> out;
    std::array<unsigned char, 256> buffer;
    for (ssize_t n; (n = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT)) >= 0;)
      EXPECT_EQ(decode(std::span(buffer).first(static_cast<std::size_t>(n)), out.emplace_back()),
                PacketFault::kNone);
    return out;
  }

 private:
  int socket_;
  sockaddr_in to_{};
};

PosePacket pose(std::uint64_t sequence, double x) {
  PosePacket out;
  out.sequence = sequence;
  out.time = 0.25;
  out.pose = {quaternion_of(Vec3(0.1, 0.2, 0.3)), Vec3(x, 2, 3)};
  out.twist = {Vec3(4, 5, 6), Vec3(7, 8, 9)};
  out.switches = 5;
  return out;
}

DeviceSpec any_port() {
  DeviceSpec spec;
  spec.type = "udp";
  spec.workspace_center_m = Vec3(0, 0, 0.5);
  return spec;
}

}  // namespace

TEST(Udp, packets_have_the_documented_bytes) {
  PosePacket packet = pose(0x0102030405060708u, 1.0);
  const PoseBytes bytes = encode(packet);
  const unsigned char head[] = {'P', 'L', 'P', 'T', 1, 0, 1, 0, 8, 7, 6, 5, 4, 3, 2, 1};
  for (std::size_t i = 0; i < sizeof head; ++i) EXPECT_EQ(bytes[i], head[i]) << i;
  const unsigned char one[] = {0, 0, 0, 0, 0, 0, 0xf0, 0x3f};  // 1.0, at the offset of px
  for (std::size_t i = 0; i < sizeof one; ++i) EXPECT_EQ(bytes[24 + i], one[i]) << i;
  EXPECT_EQ(bytes[128], 5);
  PosePacket back;
  ASSERT_EQ(decode(bytes, back), PacketFault::kNone);
  EXPECT_EQ(back.sequence, packet.sequence);
  EXPECT_EQ(back.time, 0.25);
  EXPECT_EQ(back.pose.translation, packet.pose.translation);
  EXPECT_LT((back.pose.rotation.coeffs() - packet.pose.rotation.coeffs()).norm(), 1e-15);
  EXPECT_EQ(back.twist.linear, Vec3(7, 8, 9));
  EXPECT_EQ(back.twist.angular, Vec3(4, 5, 6));
  EXPECT_EQ(back.switches, 5u);
  const WrenchBytes answer = encode(WrenchPacket{9, 0.5, {Vec3(1, 2, 3), Vec3(4, 5, 6)}});
  EXPECT_EQ(answer[6], 2);
  EXPECT_EQ(answer[31], 0x40);  // fx = 4.0
  WrenchPacket wrench;
  ASSERT_EQ(decode(answer, wrench), PacketFault::kNone);
  EXPECT_EQ(wrench.on_hand.force, Vec3(4, 5, 6));
  EXPECT_EQ(wrench.on_hand.moment, Vec3(1, 2, 3));
}

TEST(Udp, poses_come_and_wrenches_go) {
  UdpDevice device(any_port());
  const HandleSample before = device.sample(0.0);
  EXPECT_FALSE(before.valid) << "nobody has sent anything";
  EXPECT_EQ(before.pose.translation, Vec3(0, 0, 0.5));
  device.feedback(0.0, {Vec3(1, 1, 1), Vec3(1, 1, 1)});  // no peer is known yet
  Peer peer(device.port());
  for (int i = 1; i <= 20; ++i) {
    peer.send(encode(pose(static_cast<std::uint64_t>(i), 0.1 * i)));
    const HandleSample s = device.sample(1e-3 * i);
    ASSERT_TRUE(s.valid);
    EXPECT_EQ(s.pose.translation, Vec3(0.1 * i, 2, 3));
    EXPECT_EQ(s.twist.linear, Vec3(7, 8, 9));
    EXPECT_EQ(device.switches(), 5u);
    device.feedback(1e-3 * i, {Vec3(0, 0, i), Vec3(i, 0, 0)});
    const auto wrenches = peer.wrenches();
    ASSERT_EQ(wrenches.size(), 1u);
    EXPECT_EQ(wrenches[0].sequence, static_cast<std::uint64_t>(i));
    EXPECT_EQ(wrenches[0].time, 1e-3 * i);
    EXPECT_EQ(wrenches[0].on_hand.force, Vec3(i, 0, 0));
    EXPECT_EQ(wrenches[0].on_hand.moment, Vec3(0, 0, i));
  }
  EXPECT_EQ(device.counts().accepted, 20);
  EXPECT_EQ(device.counts().unsent, 0);
  EXPECT_FALSE(device.path()) << "a peer decides as it goes";
}

TEST(Udp, a_silent_peer_makes_samples_invalid_and_a_later_pose_valid_again) {
  DeviceSpec spec = any_port();
  spec.time_out_s = 0.005;
  UdpDevice device(spec);
  device.sample(0.0);
  Peer peer(device.port());
  peer.send(encode(pose(1, 0.1)));
  EXPECT_TRUE(device.sample(1.0).valid);
  EXPECT_TRUE(device.sample(1.0049).valid);
  const HandleSample late = device.sample(1.0051);
  EXPECT_FALSE(late.valid);
  EXPECT_EQ(late.pose.translation, Vec3(0.1, 2, 3)) << "it stays where it was";
  peer.send(encode(pose(2, 0.2)));
  EXPECT_TRUE(device.sample(2.0).valid);
}

TEST(Udp, what_is_no_new_pose_of_the_peer_is_counted_and_dropped) {
  UdpDevice device(any_port());
  device.sample(0.0);
  Peer peer(device.port()), other(device.port());
  peer.send(encode(pose(10, 0.1)));
  ASSERT_TRUE(device.sample(0.001).valid);

  PoseBytes bytes = encode(pose(11, 9.0));
  bytes[0] = 'Q';
  peer.send(bytes);  // magic
  bytes = encode(pose(11, 9.0));
  bytes[6] = 2;
  peer.send(bytes);  // kind
  peer.send(std::vector<unsigned char>{});
  peer.send(std::vector<unsigned char>(7, 0));
  const PoseBytes good = encode(pose(11, 9.0));
  peer.send(std::vector<unsigned char>(good.begin(), good.end() - 1));
  std::vector<unsigned char> longer(good.begin(), good.end());
  longer.push_back(0);
  peer.send(longer);
  PosePacket bad = pose(11, std::numeric_limits<double>::quiet_NaN());
  peer.send(encode(bad));
  bad = pose(11, 9.0);
  bad.pose.rotation.coeffs() *= 1.01;
  peer.send(encode(bad));
  bad = pose(11, 9.0);
  bad.twist.angular.z() = std::numeric_limits<double>::infinity();
  peer.send(encode(bad));
  bytes = encode(pose(11, 9.0));
  bytes[4] = 2;
  peer.send(bytes);                   // version
  peer.send(encode(pose(10, 9.0)));   // duplicate
  peer.send(encode(pose(9, 9.0)));    // late
  other.send(encode(pose(99, 9.0)));  // another sender
  device.sample(0.002);
  EXPECT_EQ(device.position(), Vec3(0.1, 2, 3));
  EXPECT_EQ(device.counts().malformed, 9);
  EXPECT_EQ(device.counts().wrong_version, 1);
  EXPECT_EQ(device.counts().stale, 2);
  EXPECT_EQ(device.counts().foreign, 1);
  EXPECT_EQ(device.counts().accepted, 1);
  const std::vector<std::pair<std::string, long long>> counters = {
      {"packets_accepted", 1},           {"packets_malformed", 9},
      {"packets_of_another_version", 1}, {"packets_stale", 2},
      {"packets_far_ahead", 0},          {"packets_out_of_bounds", 0},
      {"packets_from_another_peer", 1},  {"wrenches_unsent", 0}};
  EXPECT_EQ(device.counters(), counters);
  EXPECT_FALSE(device.sample(0.01).valid) << "none of them kept it alive";
  peer.send(encode(pose(12, 0.3)));
  EXPECT_TRUE(device.sample(0.011).valid);
  EXPECT_EQ(device.position(), Vec3(0.3, 2, 3));
}

// Finite poses that no hand can reach: each would have moved the tool out of the scene, or made the
// integrator fail.
TEST(Udp, poses_beyond_the_bounds_are_counted_and_dropped) {
  UdpDevice device(any_port());
  device.bound({Vec3(0, 2, 3), 1.5, 20.0, 30.0});
  device.sample(0.0);
  Peer peer(device.port());
  peer.send(encode(pose(1, 1e300)));
  EXPECT_FALSE(device.sample(0.001).valid) << "such a one does not make its sender the peer, either";
  peer.send(encode(pose(2, 0.1)));
  ASSERT_TRUE(device.sample(0.002).valid);
  std::uint64_t sequence = 3;
  const auto dropped = [&](const PosePacket& packet) {
    const long before = device.counts().out_of_bounds;
    peer.send(encode(packet));
    device.sample(0.003);
    EXPECT_EQ(device.position(), Vec3(0.1, 2, 3)) << packet.sequence;
    return device.counts().out_of_bounds - before;
  };
  for (const double x : {1.51, -1.51, 1e8, -1.7e308}) EXPECT_EQ(dropped(pose(sequence++, x)), 1) << x;
  PosePacket fast = pose(sequence++, 0.2);
  fast.twist.linear = Vec3(0, 1e200, -1e200);
  EXPECT_EQ(dropped(fast), 1);
  fast = pose(sequence++, 0.2);
  fast.twist.angular.y() = 31.0;
  EXPECT_EQ(dropped(fast), 1);
  peer.send(encode(pose(sequence, 1.49)));
  EXPECT_EQ(device.sample(0.004).pose.translation, Vec3(1.49, 2, 3));
  EXPECT_EQ(device.counts().out_of_bounds, 7);
}

// One damaged sequence number does not make all later ones old: it is dropped, and no sample of the hand is
// lost.
TEST(Udp, a_number_far_ahead_is_dropped) {
  UdpDevice device(any_port());
  device.sample(0.0);
  Peer peer(device.port());
  const auto valid = [&](std::uint64_t sequence, double t) {
    peer.send(encode(pose(sequence, 0.1 * t)));
    device.sample(t);
    return device.position().x() == 0.1 * t;
  };
  EXPECT_TRUE(valid(10, 0.001));
  for (const std::uint64_t far :
       {std::uint64_t{11} << 40, ~std::uint64_t{0}, std::uint64_t{10} + kMostAhead + 1})
    EXPECT_FALSE(valid(far, 0.002)) << far;
  EXPECT_TRUE(valid(11, 0.003));
  EXPECT_TRUE(valid(11 + 1'000'000, 0.004)) << "a clock of nanoseconds";
  EXPECT_EQ(device.counts().ahead, 3);
  EXPECT_EQ(device.counts().stale, 0);
}

// A damaged first sequence number, or a restarted peer, interrupts the device for the watchdog's 20 ms only.
TEST(Udp, numbers_begin_anew_once_the_force_has_fallen) {
  for (const std::uint64_t first : {~std::uint64_t{0}, std::uint64_t{5000}}) {
    UdpDevice device(any_port());
    device.sample(0.0);
    Peer peer(device.port());
    peer.send(encode(pose(first, 0.1)));
    ASSERT_TRUE(device.sample(0.001).valid);
    std::uint64_t sequence = 0;
    int ticks = 0;
    for (double t = 0.002; device.position().x() != 0.5 && ticks < 1000; t += 0.001, ++ticks) {
      peer.send(encode(pose(++sequence, 0.5)));
      device.sample(t);
    }
    EXPECT_NEAR(ticks, 20, 1) << first;
    peer.send(encode(pose(sequence + 1, 0.6)));
    EXPECT_TRUE(device.sample(0.03).valid);
    EXPECT_EQ(device.counts().accepted, 3);
  }
}

TEST(Udp, waits_for_the_first_pose_with_a_limit) {
  DeviceSpec spec = any_port();
  spec.wait_s = 0.05;
  UdpDevice alone(spec);
  alone.open();
  EXPECT_EQ(alone.awaited(),
            fmt::format("the first pose at 127.0.0.1, UDP port {}, for up to 0.05 s", alone.port()));
  Peer stranger(alone.port());
  stranger.send(std::vector<unsigned char>(7, 0));
  expect_contains(message_of([&] { alone.await(0.0, nullptr); }),
                  fmt::format("device: no pose arrived at 127.0.0.1, UDP port {}, within 0.05 s (1 packets "
                              "were rejected: 1 malformed",
                              alone.port()));
  spec.wait_s = 600.0;  // the test ends long before
  UdpDevice met(spec);
  met.open();
  Peer peer(met.port());
  peer.send(encode(pose(1, 0.1)));
  met.await(0.0, nullptr);
  EXPECT_TRUE(met.sample(0.0).valid) << "it is there from the first tick on";
  UdpDevice stopped(spec);
  const std::atomic<bool> stop{true};
  stopped.await(0.0, &stop);
  EXPECT_TRUE(stopped.is_live());
}

TEST(Udp, of_several_poses_in_a_tick_the_last_counts) {
  UdpDevice device(any_port());
  device.sample(0.0);
  Peer peer(device.port());
  for (std::uint64_t i = 1; i <= 5; ++i) peer.send(encode(pose(i, 0.1 * static_cast<double>(i))));
  EXPECT_EQ(device.sample(0.001).pose.translation, Vec3(0.5, 2, 3));
  EXPECT_EQ(device.counts().accepted, 5);
}

TEST(Udp, is_bound_to_this_machine_and_lets_its_port_go) {
  auto first = std::make_unique<UdpDevice>(any_port());
  first->open();
  DeviceSpec spec = any_port();
  spec.port = first->port();
  EXPECT_GT(spec.port, 0);
  expect_contains(message_of([&] { UdpDevice(spec).open(); }),
                  fmt::format("device: port = {} of 127.0.0.1 cannot be opened", spec.port));
  first.reset();
  UdpDevice second(spec);
  second.open();
  EXPECT_EQ(second.port(), spec.port);
  second.close();
  UdpDevice(spec).open();
}

TEST(Udp, bad_settings_are_refused) {
  DeviceSpec spec = any_port();
  expect_contains(message_of([&] { make_device(spec); }), "device: port = 0 must lie in [1, 65535]");
  spec.port = 65536;
  expect_contains(message_of([&] { UdpDevice{spec}; }), "port = 65536");
  spec.port = 4000;
  spec.time_out_s = 0.0;
  expect_contains(message_of([&] { UdpDevice{spec}; }), "time_out_s = 0 must be positive");
  spec.time_out_s = 0.01;
  spec.wait_s = 0.0;
  expect_contains(message_of([&] { UdpDevice{spec}; }), "wait_s = 0 must be positive");
  spec.wait_s = 1.0;
  spec.address = "localhost";
  expect_contains(message_of([&] { UdpDevice{spec}; }), "address = \"localhost\" is not an IPv4 address");
}
