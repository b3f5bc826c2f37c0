#include <bit>
#include <cmath>
#include <cstring>

#include "palpate/device/udp.h"

namespace palpate::device {
namespace {

constexpr std::uint16_t kPose = 1, kWrench = 2;

/// Byte-wise little-endian writer, independent of the host's byte order.
class Writer {
 public:
  explicit Writer(std::span<unsigned char> out) : out_(out) {}
  template <class Integer>
  void integer(Integer value) {
    for (std::size_t i = 0; i < sizeof value; ++i)
      out_[at_++] = static_cast<unsigned char>(static_cast<std::uint64_t>(value) >> (8 * i));
  }
  void number(double value) { integer(std::bit_cast<std::uint64_t>(value)); }
  void vec(const Vec3& v) {
    for (const double one : v) number(one);
  }
  void head(std::uint16_t kind, std::uint64_t sequence, double time) {
    integer(kUdpMagic), integer(kUdpVersion), integer(kind), integer(sequence), number(time);
  }

 private:
  std::span<unsigned char> out_;
  std::size_t at_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const unsigned char> in) : in_(in) {}
  template <class Integer>
  Integer integer() {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Integer); ++i) value |= std::uint64_t{in_[at_++]} << (8 * i);
    return static_cast<Integer>(value);
  }
  double number() {
    const double value = std::bit_cast<double>(integer<std::uint64_t>());
    finite_ = finite_ && std::isfinite(value);
    return value;
  }
  Vec3 vec() {
    Vec3 out;
    for (double& one : out) one = number();
    return out;
  }
  bool all_finite() const { return finite_; }

 private:
  std::span<const unsigned char> in_;
  std::size_t at_ = 0;
  bool finite_ = true;
};

PacketFault read_head(Reader& in, std::size_t size, std::size_t right_size, std::uint16_t right_kind) {
  constexpr std::size_t kHead = 8;
  if (size < kHead || in.integer<std::uint32_t>() != kUdpMagic) return PacketFault::kMalformed;
  if (in.integer<std::uint16_t>() != kUdpVersion) return PacketFault::kVersion;
  const bool good = in.integer<std::uint16_t>() == right_kind && size == right_size;
  return good ? PacketFault::kNone : PacketFault::kMalformed;
}

}  // namespace

PoseBytes encode(const PosePacket& packet) {
  PoseBytes bytes;
  Writer out(bytes);
  out.head(kPose, packet.sequence, packet.time);
  out.vec(packet.pose.translation);
  out.number(packet.pose.rotation.w());
  out.vec(packet.pose.rotation.vec());
  out.vec(packet.twist.linear);
  out.vec(packet.twist.angular);
  out.integer(packet.switches);
  return bytes;
}

WrenchBytes encode(const WrenchPacket& packet) {
  WrenchBytes bytes;
  Writer out(bytes);
  out.head(kWrench, packet.sequence, packet.time);
  out.vec(packet.on_hand.force);
  out.vec(packet.on_hand.moment);
  return bytes;
}

PacketFault decode(std::span<const unsigned char> bytes, PosePacket& out) {
  Reader in(bytes);
  const PacketFault fault = read_head(in, bytes.size(), PoseBytes{}.size(), kPose);
  if (fault != PacketFault::kNone) return fault;
  PosePacket packet;
  packet.sequence = in.integer<std::uint64_t>();
  packet.time = in.number();
  packet.pose.translation = in.vec();
  const double w = in.number();
  const Vec3 v = in.vec();
  packet.twist.linear = in.vec();
  packet.twist.angular = in.vec();
  packet.switches = in.integer<std::uint32_t>();
  const Quat q(w, v.x(), v.y(), v.z());
  if (!in.all_finite() || !(std::abs(q.norm() - 1.0) < 1e-3)) return PacketFault::kMalformed;
  packet.pose.rotation = q.normalized();
  out = packet;
  return PacketFault::kNone;
}

PacketFault decode(std::span<const unsigned char> bytes, WrenchPacket& out) {
  Reader in(bytes);
  const PacketFault fault = read_head(in, bytes.size(), WrenchBytes{}.size(), kWrench);
  if (fault != PacketFault::kNone) return fault;
  WrenchPacket packet;
  packet.sequence = in.integer<std::uint64_t>();
  packet.time = in.number();
  packet.on_hand.force = in.vec();
  packet.on_hand.moment = in.vec();
  if (!in.all_finite()) return PacketFault::kMalformed;
  out = packet;
  return PacketFault::kNone;
}

}  // namespace palpate::device
