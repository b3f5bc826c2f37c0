#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "palpate/device/device.h"

/// A device on the network: a peer sends poses in UDP packets and gets a wrench for each tick.
///
/// All numbers are little-endian, without gaps; doubles are IEEE 754.  A pose is 132 bytes, a wrench 72:
///
///   offset  pose (peer to palpate)             offset  wrench (palpate to peer)
///   0       magic u32, "PLPT"                  0       magic u32, "PLPT"
///   4       version u16, 1                     4       version u16, 1
///   6       kind u16, 1                        6       kind u16, 2
///   8       sequence u64, rises                8       sequence u64, of the last pose that counted
///   16      time f64 [s], the peer's own       16      time f64 [s], of the tick
///   24      position 3 f64 [m]                 24      force on the hand 3 f64 [N]
///   48      rotation w, x, y, z 4 f64          48      torque about the handle's origin 3 f64 [N m]
///   80      linear velocity 3 f64 [m/s]
///   104     angular velocity 3 f64 [rad/s]
///   128     switches u32
///
/// A sequence counts packets, or is the peer's clock, in nanoseconds at the finest.  One that does not rise
/// is an old packet, or one that is sent again; one that is more than kMostAhead ahead is damaged: neither
/// counts. Once no pose has counted for kFallTime (limiter.h) the force has fallen to zero, and the peer's
/// next number counts whatever it is: a peer may start anew, and none locks itself out.  There is no
/// encryption: whoever can send to the port first moves the handle.
namespace palpate::device {

/// the bytes P L P T
inline constexpr std::uint32_t kUdpMagic = 0x54504c50;  // the bytes P L P T
inline constexpr std::uint16_t kUdpVersion = 1;         ///< of both packets

/// Largest rise of a sequence from one pose to the next: a second of nanoseconds, far beyond kFallTime.
inline constexpr std::uint64_t kMostAhead = 1'000'000'000;

/// What a peer sends.
struct PosePacket {
  std::uint64_t sequence = 0;  ///< rises from packet to packet
  double time = 0.0;           ///< the peer's own [s]
  Pose pose;                   ///< of the handle, scene's axes
  Twist twist;                 ///< [rad/s, m/s]
  std::uint32_t switches = 0;  ///< bit i: switch i is pressed
};
/// What it gets back, a packet a tick.
struct WrenchPacket {
  std::uint64_t sequence = 0;  ///< of the last pose that counted
  double time = 0.0;           ///< of the tick [s]
  Wrench on_hand;              ///< force and moment about the handle's origin [N, N m]
};
/// A pose as it travels.
using PoseBytes = std::array<unsigned char, 132>;
/// A wrench as it travels.
using WrenchBytes = std::array<unsigned char, 72>;

/// Why a packet does not count.
enum class PacketFault { kNone, kMalformed, kVersion };

/// The bytes of a packet, as the table above has them.
PoseBytes encode(const PosePacket& packet);
/// The bytes of a packet, as the table above has them.
WrenchBytes encode(const WrenchPacket& packet);
/// Malformed: another size, magic or kind, a number that is not finite, a quaternion whose length is not 1 to
/// 1e-3.  `out` is written only where there is no fault.
PacketFault decode(std::span<const unsigned char> bytes, PosePacket& out);
/// Likewise, of a wrench.
PacketFault decode(std::span<const unsigned char> bytes, WrenchPacket& out);

/// Packets by what became of them.
struct UdpCounts {
  long accepted = 0, malformed = 0, wrong_version = 0;  ///< packets by what they were
  long stale = 0;                                       ///< a sequence that did not rise
  long ahead = 0;                                       ///< a sequence that rose by more than kMostAhead
  long out_of_bounds = 0;                               ///< a pose or speed beyond PoseBounds
  long foreign = 0;  ///< from another address than the first that was accepted
  long unsent = 0;   ///< wrenches that the network did not take
};

/// The device.  A sample takes what has come, never waits, and repeats the last pose between packets; it is
/// valid while the last one came at most time_out_s ago, by the loop's clock.  Before the first it is not,
/// and stands at the workspace's center; await() waits for it for up to wait_s.
class UdpDevice : public Device {
 public:
  /// @param spec  its port may be 0: any that is free
  explicit UdpDevice(const DeviceSpec& spec);
  ~UdpDevice() override { close(); }
  DeviceSpecification specification() const override { return specification_; }
  /// Since it was made.
  const UdpCounts& counts() const { return counts_; }
  std::vector<std::pair<std::string, long long>> tallies() const override;
  int port() const { return port_; }  ///< that it is bound to, once it is open
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
    std::uint32_t host = 0;  ///< network order, as is the port
    std::uint16_t port = 0;
    bool operator==(const Address&) const = default;
  };
  bool take(std::span<const unsigned char> bytes, const Address& from, double t);
  void receive(double t);  ///< what has come by now

  std::string address_;
  int port_;
  double time_out_, wait_;
  DeviceSpecification specification_;
  int socket_ = -1;
  PosePacket last_;
  std::optional<Address> peer_;  ///< empty until a packet is accepted
  double arrived_ = 0.0;         ///< loop's time of the last accepted one [s]
  PoseBounds bounds_;
  UdpCounts counts_;
};

}  // namespace palpate::device
