#include "spacemouse.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "make.h"
#include "palpate/core/error.h"
#include "palpate/device/profile.h"

namespace palpate::device {

void apply_packet(const SpacemousePacket& packet, SpacemouseState& state) {
  constexpr double kFull = 350.0;
  const auto axis = [&](std::size_t i) { return packet[i] / kFull; };
  if (packet[0] == 0) {
    // The daemon's clients draw with (x, y, -z) and (rx, ry, -rz) in axes with y up and z towards the user; a
    // quarter turn about x leads to y away and z up.
    state.deflection.linear = {axis(1), axis(3), axis(2)};
    state.deflection.angular = {axis(4), axis(6), axis(5)};
    ++state.motions;
  } else if ((packet[0] == 1 || packet[0] == 2) && packet[1] >= 0 && packet[1] < 32) {
    const std::uint32_t bit = std::uint32_t{1} << packet[1];
    state.switches = packet[0] == 1 ? state.switches | bit : state.switches & ~bit;
    ++state.buttons;
  } else {
    ++state.others;
  }
}

std::string spacemouse_socket(const DeviceSpec& spec) {
  if (!spec.input.empty()) return spec.input;
  const char* const named = std::getenv("SPNAV_SOCKET");
  return named && *named ? named : "/run/spnav.sock";
}

namespace {

class Spacemouse : public Device {
 public:
  explicit Spacemouse(const DeviceSpec& spec)
      : path_(spacemouse_socket(spec)), rate_(spec), specification_(figures_of(spec).specification) {}
  ~Spacemouse() override { close(); }
  DeviceSpecification specification() const override { return specification_; }
  bool is_live() const override { return true; }
  void bound(const PoseBounds& bounds) override { rate_.bound(bounds); }
  std::vector<std::pair<std::string, long long>> counters() const override {
    return {{"motion_packets", state_.motions},
            {"button_packets", state_.buttons},
            {"other_packets", state_.others},
            {"connections_lost", lost_}};
  }

 protected:
  void do_open() override {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path_.size() >= sizeof address.sun_path)
      fail("device: input = \"{}\" is too long for a socket: at most {} characters", path_,
           sizeof address.sun_path - 1);
    std::strcpy(address.sun_path, path_.c_str());
    socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    // The socket interface requires this cast.
    if (socket_ < 0 || ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
      const std::string why = std::strerror(errno);
      do_close();
      fail(
          "device: no daemon of a SpaceMouse answers at {} ({}); start spacenavd, or set device.input or "
          "SPNAV_SOCKET to its socket",
          path_, why);
    }
  }
  void do_close() override {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }
  HandleSample do_sample(double t) override {
    receive();
    rate_.advance(t, state_.deflection);
    HandleSample out;
    out.pose = rate_.pose();
    out.twist = rate_.twist();
    out.switches = state_.switches;
    out.valid = socket_ >= 0;
    return out;
  }

 private:
  void receive() {
    constexpr int kMostPackets = 256;  // a flood does not delay a tick
    for (int i = 0; i < kMostPackets && socket_ >= 0; ++i) {
      const ssize_t n = ::recv(socket_, bytes_.data() + filled_, bytes_.size() - filled_, 0);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
      if (n <= 0) return disconnect();
      filled_ += static_cast<std::size_t>(n);
      if (filled_ < bytes_.size()) continue;
      filled_ = 0;
      apply_packet(std::bit_cast<SpacemousePacket>(bytes_), state_);
    }
  }
  void disconnect() {
    do_close();
    ++lost_;
    state_.deflection = {};
    state_.switches = 0;
  }

  std::string path_;
  RateControl rate_;
  DeviceSpecification specification_;
  int socket_ = -1;
  std::array<unsigned char, sizeof(SpacemousePacket)> bytes_{};
  std::size_t filled_ = 0;  ///< Bytes of an incomplete packet.
  SpacemouseState state_;
  long long lost_ = 0;
};

}  // namespace

std::unique_ptr<Device> make_spacemouse(const DeviceSpec& spec, const std::string&) {
  return std::make_unique<Spacemouse>(spec);
}

}  // namespace palpate::device
