#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "palpate/device/device.h"

/// Network device: a peer sends poses in UDP packets and receives one wrench per tick.
///
/// All numbers are little-endian, without gaps; doubles are IEEE 754. A pose packet has 132 bytes, a wrench
/// packet 72:
///
///   offset  pose (peer to palpate)             offset  wrench (palpate to peer)
///   0       magic u32, "PLPT"                  0       magic u32, "PLPT"
///   4       version u16, 1                     4       version u16, 1
///   6       kind u16, 1                        6       kind u16, 2
///   8       sequence u64, rises                8       sequence u64, of the last accepted pose
///   16      time f64 [s], the peer's clock     16      time f64 [s], of the tick
///   24      position 3 f64 [m]                 24      force on the hand 3 f64 [N]
///   48      rotation w, x, y, z 4 f64          48      torque about the handle's origin 3 f64 [N m]
///   80      linear velocity 3 f64 [m/s]
///   104     angular velocity 3 f64 [rad/s]
///   128     switches u32
///
/// A sequence number counts packets, or is the peer's clock with a resolution of a nanosecond at most. A
/// number that does not rise belongs to an old or repeated packet, and a number more than kMostAhead ahead to
/// a damaged one: both are dropped. If no pose was accepted for kFallTime (limiter.h), the force has fallen
/// to zero, and the next number of the peer is accepted whatever it is: a peer may restart, and none can lock
/// itself out. There is no encryption: the first sender that reaches the port controls the handle.
namespace palpate::device {

/// Magic number: the bytes P L P T.
inline constexpr std::uint32_t kUdpMagic = 0x54504c50;
inline constexpr std::uint16_t kUdpVersion = 1;  ///< Version of both packets.

/// Largest rise of the sequence number from one pose to the next: one second in nanoseconds, far beyond
/// kFallTime.
inline constexpr std::uint64_t kMostAhead = 1'000'000'000;

/// Packet from the peer: pose of the handle.
struct PosePacket {
  std::uint64_t sequence = 0;  ///< Rises from packet to packet.
  double time = 0.0;           ///< The peer's clock [s].
  Pose pose;                   ///< Pose of the handle, scene's axes.
  Twist twist;                 ///< [rad/s, m/s]
  std::uint32_t switches = 0;  ///< Bit i: switch i is pressed.
};
/// Packet to the peer, one per tick: wrench on the hand.
struct WrenchPacket {
  std::uint64_t sequence = 0;  ///< Number of the last accepted pose.
  double time = 0.0;           ///< Time of the tick [s].
  Wrench on_hand;              ///< Force and moment about the handle's origin [N, N m].
};
/// Serialised pose packet.
using PoseBytes = std::array<unsigned char, 132>;
/// Serialised wrench packet.
using WrenchBytes = std::array<unsigned char, 72>;

/// Reason for which decode() rejects a packet.
enum class PacketFault { kNone, kMalformed, kVersion };

/// Serialises a packet in the format of the table above.
PoseBytes encode(const PosePacket& packet);
/// Serialises a packet in the format of the table above.
WrenchBytes encode(const WrenchPacket& packet);
/// Parses a pose packet. It is malformed if size, magic or kind differ, a number is not finite, or the
/// norm of the quaternion differs from 1 by 1e-3 or more. `out` is written only if there is no fault.
PacketFault decode(std::span<const unsigned char> bytes, PosePacket& out);
/// Parses a wrench packet. It is malformed if size, magic or kind differ or a number is not finite. `out` is
/// written only if there is no fault.
PacketFault decode(std::span<const unsigned char> bytes, WrenchPacket& out);

/// Counters of received and sent packets.
struct UdpCounts {
  long accepted = 0, malformed = 0, wrong_version = 0;  ///< Packets accepted, or rejected by decode().
  long stale = 0;                                       ///< Sequence number did not rise.
  long ahead = 0;                                       ///< Sequence number rose by more than kMostAhead.
  long out_of_bounds = 0;                               ///< Pose or speed beyond PoseBounds.
  long foreign = 0;                                     ///< Sender is not the accepted peer.
  long unsent = 0;                                      ///< Wrenches that the network did not accept.
};

/// The network device. A sample reads the packets received so far, never waits, and repeats the last pose
/// between packets; it is valid if the last pose arrived at most time_out_s ago on the loop's clock. Before
/// the first pose the sample is invalid, at the workspace's centre; await() waits for the first pose for up
/// to wait_s.
class UdpDevice : public Device {
 public:
  /// @param spec  spec of the device; port 0 selects any free port
  explicit UdpDevice(const DeviceSpec& spec);
  ~UdpDevice() override { close(); }
  DeviceSpecification specification() const override { return specification_; }
  /// Returns the counters since construction.
  const UdpCounts& counts() const { return counts_; }
  std::vector<std::pair<std::string, long long>> counters() const override;
  int port() const { return port_; }  ///< Bound port, once the device is open.
  bool is_live() const override { return true; }
  std::string awaited() const override;
  void bound(const PoseBounds& bounds) override { bounds_ = bounds; }

 protected:
  void do_open() override;
  void do_close() override;
  void do_await(double t, const std::atomic<bool>* stop) override;
  HandleSample do_sample(double t) override;
  void do_feedback(double t, const Wrench& on_hand) override;

 private:
  struct Address {
    std::uint32_t host = 0;  ///< Network byte order, as for the port.
    std::uint16_t port = 0;
    bool operator==(const Address&) const = default;
  };
  /// Checks one packet and adopts its pose; returns whether it was accepted.
  bool take(std::span<const unsigned char> bytes, const Address& from, double t);
  void receive(double t);  ///< Reads all packets received so far.

  std::string address_;
  int port_;
  double time_out_, wait_;
  DeviceSpecification specification_;
  int socket_ = -1;
  PosePacket last_;
  std::optional<Address> peer_;  ///< Empty until a packet is accepted.
  double arrived_ = 0.0;         ///< Loop time of the last accepted packet [s].
  PoseBounds bounds_;
  UdpCounts counts_;
};

}  // namespace palpate::device
