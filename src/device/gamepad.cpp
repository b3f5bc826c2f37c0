// Game pad by Linux's event interface (linux/input.h): /dev/input/eventN.
#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "gamepad_state.h"
#include "make.h"
#include "palpate/core/error.h"
#include "palpate/device/profile.h"

namespace palpate::device {
namespace {

/// Set of event codes that the kernel reports.
struct CodeSet {
  std::array<unsigned char, KEY_MAX / 8 + 1> bits{};
  bool has(unsigned code) const { return bits[code / 8] & (1u << (code % 8)); }
};

CodeSet codes_of(int file, int type) {
  CodeSet out;
  if (::ioctl(file, EVIOCGBIT(static_cast<unsigned>(type), out.bits.size()), out.bits.data()) < 0) return {};
  return out;
}

bool is_gamepad(int file) {
  return codes_of(file, EV_KEY).has(BTN_GAMEPAD) && codes_of(file, EV_ABS).has(ABS_X);
}

/// Opens for reading and, where permitted, for rumble.
int open_events(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  return file >= 0 ? file : ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
}

/// Rumble by the size of the force. An effect lasts half a second and is renewed, so that a program that
/// hangs does not leave it on. The kernel is called at most every 20 ms, because the pad's driver has to pass
/// each change through USB or radio.
class Rumble {
 public:
  /// Uploads no effect yet.  @param file  an open event device
  void start(int file) {
    file_ = codes_of(file, EV_FF).has(FF_RUMBLE) ? file : -1;
    effect_ = {};
    effect_.id = -1;
    level_ = 0.0;
    sent_ = -1.0;
  }
  void stop() {
    if (file_ >= 0 && effect_.id >= 0) ::ioctl(file_, EVIOCRMFF, static_cast<int>(effect_.id));
    file_ = -1;
  }
  /// @param level  0 to 1
  void set(double t, double level) {
    constexpr double kLeastInterval = 0.02, kRenewal = 0.25, kStep = 0.02;
    const double age = t - sent_;
    if (file_ < 0 || (sent_ >= 0.0 && age < kLeastInterval)) return;
    if (std::abs(level - level_) < kStep && (level_ == 0.0 || age < kRenewal)) return;
    effect_.type = FF_RUMBLE;
    effect_.replay.length = 500;
    effect_.u.rumble.strong_magnitude = static_cast<std::uint16_t>(65535.0 * std::min(level, 1.0));
    if (::ioctl(file_, EVIOCSFF, &effect_) < 0) return;
    input_event play{};
    play.type = EV_FF;
    play.code = static_cast<std::uint16_t>(effect_.id);
    play.value = 1;
    if (::write(file_, &play, sizeof play) != sizeof play) return;
    level_ = level;
    sent_ = t;
    ++changes_;
  }
  long long changes() const { return changes_; }

 private:
  int file_ = -1;
  ff_effect effect_{};
  double level_ = 0.0, sent_ = -1.0;
  long long changes_ = 0;
};

class Gamepad : public Device {
 public:
  explicit Gamepad(const DeviceSpec& spec) : path_(spec.input), rate_(spec) {
    const DeviceFigures figures = figures_of(spec);
    specification_ = figures.specification;
    max_force_ = figures.max_force;
  }
  ~Gamepad() override { close(); }
  DeviceSpecification specification() const override { return specification_; }
  bool is_live() const override { return true; }
  void bound(const PoseBounds& bounds) override { rate_.bound(bounds); }
  std::vector<std::pair<std::string, long long>> counters() const override {
    return {
        {"pad_events", state_.events()}, {"rumble_changes", rumble_.changes()}, {"connections_lost", lost_}};
  }

 protected:
  void do_open() override {
    file_ = path_.empty() ? find() : open_events(path_);
    if (file_ < 0)
      fail(
          "device: input = \"{}\" cannot be opened ({}); an event device needs membership of the group "
          "\"input\"",
          path_, std::strerror(errno));
    read_axes();
    rumble_.start(file_);
  }
  void do_close() override {
    rumble_.stop();
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }
  HandleSample do_sample(double t) override {
    receive();
    rate_.advance(t, state_.deflection());
    HandleSample out;
    out.pose = rate_.pose();
    out.twist = rate_.twist();
    out.switches = state_.switches();
    out.valid = file_ >= 0;
    return out;
  }
  void do_feedback(double t, const Wrench& on_hand) override {
    if (file_ >= 0) rumble_.set(t, on_hand.force.norm() / max_force_);
  }

 private:
  /// Returns the first game pad of this machine.
  static int find() {
    constexpr int kMostDevices = 64;
    int closed = 0;
    for (int i = 0; i < kMostDevices; ++i) {
      const std::string path = fmt::format("/dev/input/event{}", i);
      const int file = open_events(path);
      if (file < 0) {
        closed += errno == EACCES;
        continue;
      }
      if (is_gamepad(file)) return file;
      ::close(file);
    }
    fail("device: no game pad among /dev/input/event*{}; connect one, or set device.input to its event file",
         closed > 0 ? fmt::format(" ({} of them need membership of the group \"input\")", closed) : "");
  }

  /// Reads ranges and values of the axes. A pipe or a file with recorded events reports none: the ranges are
  /// then those of an Xbox pad.
  void read_axes() {
    state_.release();
    for (int code = ABS_X; code <= ABS_RZ; ++code) {
      input_absinfo info{};
      if (::ioctl(file_, EVIOCGABS(static_cast<unsigned>(code)), &info) >= 0)
        state_.set_axis(code, {info.minimum, info.maximum}, info.value);
    }
  }

  void receive() {
    constexpr int kMostEvents = 1024;  // a flood does not delay a tick
    for (int i = 0; i < kMostEvents && file_ >= 0; ++i) {
      input_event event;
      const ssize_t n = ::read(file_, &event, sizeof event);
      if (n == static_cast<ssize_t>(sizeof event)) {
        if (!state_.apply(event)) read_axes();
        continue;
      }
      if (n < 0 && errno == ENODEV) disconnect();
      if (n < 0 && errno == EINTR) continue;
      return;
    }
  }
  void disconnect() {
    do_close();
    ++lost_;
    state_.release();
  }

  std::string path_;
  RateControl rate_;
  DeviceSpecification specification_;
  double max_force_ = 0.0;
  int file_ = -1;
  GamepadState state_;
  Rumble rumble_;
  long long lost_ = 0;
};

}  // namespace

std::unique_ptr<Device> make_gamepad(const DeviceSpec& spec, const std::string&) {
  return std::make_unique<Gamepad>(spec);
}

}  // namespace palpate::device
