#include "palpate/device/udp.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "device/check_range.h"
#include "device/make.h"
#include "palpate/core/error.h"
#include "palpate/device/limiter.h"
#include "palpate/device/profile.h"

namespace palpate::device {
namespace {

sockaddr_in address_of(std::uint32_t host, std::uint16_t port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_addr.s_addr = host;
  out.sin_port = port;
  return out;
}

// The socket interface requires this cast.
sockaddr* generic(sockaddr_in& address) { return reinterpret_cast<sockaddr*>(&address); }

}  // namespace

UdpDevice::UdpDevice(const DeviceSpec& spec)
    : address_(spec.address),
      port_(spec.port),
      time_out_(spec.time_out_s),
      wait_(spec.wait_s),
      specification_(figures_of(spec).specification) {
  if (port_ != 0) check_range("port", port_, DeviceRanges::port);
  check_range("time_out_s", time_out_, DeviceRanges::time_out_s);
  check_range("wait_s", wait_, DeviceRanges::wait_s);
  in_addr host{};
  if (::inet_pton(AF_INET, address_.c_str(), &host) != 1)
    fail(
        "device: address = \"{}\" is not an IPv4 address; use \"127.0.0.1\" to accept only peers on this "
        "machine",
        address_);
  last_.pose.translation = spec.workspace_center_m;
}

void UdpDevice::do_open() {
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  in_addr host{};
  ::inet_pton(AF_INET, address_.c_str(), &host);
  sockaddr_in own = address_of(host.s_addr, htons(static_cast<std::uint16_t>(port_)));
  socklen_t size = sizeof own;
  if (socket_ < 0 || ::bind(socket_, generic(own), size) != 0 ||
      ::getsockname(socket_, generic(own), &size) != 0) {
    const std::string why = std::strerror(errno);
    do_close();
    fail("device: port = {} of {} cannot be opened ({}); choose another port", port_, address_, why);
  }
  port_ = ntohs(own.sin_port);
}

void UdpDevice::do_close() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

std::vector<std::pair<std::string, long long>> UdpDevice::counters() const {
  return {{"packets_accepted", counts_.accepted},
          {"packets_malformed", counts_.malformed},
          {"packets_of_another_version", counts_.wrong_version},
          {"packets_stale", counts_.stale},
          {"packets_far_ahead", counts_.ahead},
          {"packets_out_of_bounds", counts_.out_of_bounds},
          {"packets_from_another_peer", counts_.foreign},
          {"wrenches_unsent", counts_.unsent}};
}

bool UdpDevice::take(std::span<const unsigned char> bytes, const Address& from, double t) {
  PosePacket packet;
  switch (decode(bytes, packet)) {
    case PacketFault::kMalformed: ++counts_.malformed; return false;
    case PacketFault::kVersion: ++counts_.wrong_version; return false;
    case PacketFault::kNone: break;
  }
  if (peer_ && !(*peer_ == from)) return ++counts_.foreign, false;
  if (peer_ && t - arrived_ <= kFallTime) {
    if (packet.sequence <= last_.sequence) return ++counts_.stale, false;
    if (packet.sequence - last_.sequence > kMostAhead) return ++counts_.ahead, false;
  }
  if (!bounds_.hold(packet.pose, packet.twist)) return ++counts_.out_of_bounds, false;
  peer_ = from;
  last_ = packet;
  arrived_ = t;
  ++counts_.accepted;
  return true;
}

void UdpDevice::receive(double t) {
  // A peer that floods the port does not delay a tick: remaining packets are read at the next one.
  constexpr int kMostPackets = 256;
  std::array<unsigned char, 512> buffer;
  for (int i = 0; i < kMostPackets; ++i) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t n = ::recvfrom(socket_, buffer.data(), buffer.size(), 0, generic(from), &size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) break;
    take(std::span(buffer).first(static_cast<std::size_t>(n)), {from.sin_addr.s_addr, from.sin_port}, t);
  }
}

std::string UdpDevice::awaited() const {
  return fmt::format("the first pose at {}, UDP port {}, for up to {:g} s", address_, port_, wait_);
}

void UdpDevice::do_await(double t, const std::atomic<bool>* stop) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(wait_);
  for (receive(t); !peer_ && !(stop && *stop); receive(t)) {
    const double left_ms = std::chrono::duration<double, std::milli>(end - Clock::now()).count();
    if (left_ms <= 0.0) {
      const long others = counts_.malformed + counts_.wrong_version + counts_.out_of_bounds;
      fail(
          "device: no pose arrived at {}, UDP port {}, within {:g} s{}; start the peer, check its address "
          "and port, or increase device.wait_s",
          address_, port_, wait_,
          others > 0
              ? fmt::format(
                    " ({} packets were rejected: {} malformed, {} of another version, {} out of bounds)",
                    others, counts_.malformed, counts_.wrong_version, counts_.out_of_bounds)
              : "");
    }
    pollfd readable{socket_, POLLIN, 0};
    ::poll(&readable, 1, 1 + static_cast<int>(std::min(left_ms, 50.0)));  // short enough to notice `stop`
  }
}

HandleSample UdpDevice::do_sample(double t) {
  receive(t);
  HandleSample out;
  out.pose = last_.pose;
  out.twist = last_.twist;
  out.switches = last_.switches;
  out.valid = peer_.has_value() && t - arrived_ <= time_out_;
  return out;
}

void UdpDevice::do_feedback(double t, const Wrench& on_hand) {
  if (!peer_) return;
  const WrenchBytes bytes = encode(WrenchPacket{last_.sequence, t, on_hand});
  sockaddr_in to = address_of(peer_->host, peer_->port);
  const ssize_t n = ::sendto(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL, generic(to), sizeof to);
  counts_.unsent += n != static_cast<ssize_t>(bytes.size());
}

std::unique_ptr<Device> make_udp(const DeviceSpec& spec, const std::string&) {
  check_range("port", spec.port, DeviceRanges::port);
  return std::make_unique<UdpDevice>(spec);
}

}  // namespace palpate::device
