// The game pad, with recorded events through a named pipe. This file answers the requests that the kernel
// answers for an event device.
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>

#include <cerrno>
#include <cstdarg>

#include "device/gamepad_state.h"
#include "messages.h"
#include "palpate/device/registry.h"
#include "stand_ins.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace palpate::device;
using palpate::expectations::expect_contains;
using palpate::expectations::message_of;

namespace {

/// A pad with sticks of 8 bits and a motor, while it is on.
struct Kernel {
  bool is_on = false;
  std::vector<std::uint16_t> rumbles;
  int erased = 0;
} kernel;

int answer(unsigned long request, void* data) {
  if (_IOC_TYPE(request) != 'E') return -1;
  const unsigned number = _IOC_NR(request);
  if (number >= 0x40 && number <= 0x45) {  // EVIOCGABS
    input_absinfo info{};
    info.value = 100;
    info.maximum = 200;
    *static_cast<input_absinfo*>(data) = info;
    return 0;
  }
  if (number >= 0x20 && number < 0x40) {  // EVIOCGBIT
    std::memset(data, 0, _IOC_SIZE(request));
    if (number == 0x20 + EV_FF) static_cast<unsigned char*>(data)[FF_RUMBLE / 8] |= 1u << (FF_RUMBLE % 8);
    return static_cast<int>(_IOC_SIZE(request));
  }
  if (request == EVIOCSFF) {
    auto* const effect = static_cast<ff_effect*>(data);
    EXPECT_EQ(effect->type, FF_RUMBLE);
    EXPECT_EQ(effect->id, kernel.rumbles.empty() ? -1 : 3) << "changes keep the effect";
    effect->id = 3;
    kernel.rumbles.push_back(effect->u.rumble.strong_magnitude);
    return 0;
  }
  if (request == EVIOCRMFF) return ++kernel.erased, 0;
  return -1;
}

DeviceSpec spec_of(const std::string& path) {
  DeviceSpec spec;
  spec.type = "gamepad";
  spec.input = path;
  spec.max_speed_m_s = 0.1;
  spec.max_turn_rate_rad_s = 2.0;
  spec.dead_zone = 0.0;
  spec.max_force_n = 4.0;
  return spec;
}

}  // namespace

/// Takes the place of libc's function in this program.
extern "C" int ioctl(int file, unsigned long request, ...) noexcept {
  va_list list;
  va_start(list, request);
  void* const data = va_arg(list, void*);
  va_end(list);
  if (kernel.is_on && _IOC_TYPE(request) == 'E') return answer(request, data);
  return static_cast<int>(::syscall(SYS_ioctl, file, request, data));
}

TEST(Gamepad, sticks_and_triggers_set_the_velocity) {
  const TemporaryFolder folder;
  EventPipe pipe((folder / "event0").string());
  const auto device = make_device(spec_of((folder / "event0").string()));
  EXPECT_LT(device->sample(0.0).twist.linear.norm(), 3e-6) << "at rest: half a count of 65535";
  pipe.send(EV_ABS, ABS_X, 32767);
  pipe.send(EV_ABS, ABS_Y, 32767);  // towards the user
  pipe.send(EV_ABS, ABS_RZ, 255);
  pipe.send(EV_ABS, ABS_RX, -32768);
  pipe.send(EV_ABS, ABS_RY, -32768);
  pipe.send(EV_SYN, SYN_REPORT, 0);
  const HandleSample s = device->sample(0.1);
  EXPECT_LT((s.twist.linear - Vec3(0.1, -0.1, 0.1)).norm(), 1e-14);
  EXPECT_LT((s.twist.angular - Vec3(-2, 0, 2)).norm(), 1e-14) << "forward, and to the left";
  EXPECT_NEAR(device->sample(0.6).pose.translation.z(), 0.05, 1e-6);
  pipe.send(EV_ABS, ABS_Z, 255);
  EXPECT_NEAR(device->sample(0.6).twist.linear.z(), 0.0, 1e-14) << "both triggers";
}

TEST(Gamepad, buttons_are_switches) {
  const TemporaryFolder folder;
  EventPipe pipe((folder / "event0").string());
  const auto device = make_device(spec_of((folder / "event0").string()));
  device->open();
  pipe.send(EV_KEY, BTN_SOUTH, 1);
  pipe.send(EV_KEY, BTN_TR, 1);
  pipe.send(EV_KEY, KEY_A, 1);
  EXPECT_EQ(device->sample(0.0).switches, (1u << 0) | (1u << 7));
  pipe.send(EV_KEY, BTN_SOUTH, 0);
  EXPECT_EQ(device->sample(0.1).switches, 1u << 7);
  EXPECT_EQ(device->counters()[0], (std::pair<std::string, long long>("pad_events", 3)));
}

TEST(Gamepad, ranges_are_the_kernels_and_are_read_again_after_lost_events) {
  const TemporaryFolder folder;
  EventPipe pipe((folder / "event0").string());
  kernel = {};
  kernel.is_on = true;
  const auto device = make_device(spec_of((folder / "event0").string()));
  EXPECT_EQ(device->sample(0.0).twist.linear.x(), 0.0) << "100 of 0 to 200";
  pipe.send(EV_ABS, ABS_X, 150);
  EXPECT_NEAR(device->sample(0.1).twist.linear.x(), 0.05, 1e-14);
  pipe.send(EV_SYN, SYN_DROPPED, 0);
  EXPECT_EQ(device->sample(0.2).twist.linear.x(), 0.0);
  kernel.is_on = false;
}

TEST(Gamepad, rumbles_by_the_force_at_a_bounded_rate) {
  const TemporaryFolder folder;
  EventPipe pipe((folder / "event0").string());
  kernel = {};
  kernel.is_on = true;
  auto device = make_device(spec_of((folder / "event0").string()));
  const auto push = [&](double t, double force) {
    device->sample(t);
    device->feedback(t, {Vec3::Zero(), Vec3(0, force, 0)});
  };
  push(0.0, 0.0);
  EXPECT_TRUE(kernel.rumbles.empty()) << "no force, no effect";
  push(0.001, 2.0);
  ASSERT_EQ(kernel.rumbles.size(), 1u);
  EXPECT_NEAR(kernel.rumbles.back(), 32767, 1) << "half the maximum force";
  for (int i = 2; i <= 20; ++i) push(1e-3 * i, 4.0);
  EXPECT_EQ(kernel.rumbles.size(), 1u) << "within 20 ms of the last change";
  push(0.022, 4.0);
  ASSERT_EQ(kernel.rumbles.size(), 2u);
  EXPECT_EQ(kernel.rumbles.back(), 65535);
  push(0.1, 4.01);
  EXPECT_EQ(kernel.rumbles.size(), 2u) << "hardly a change";
  push(0.3, 4.0);
  EXPECT_EQ(kernel.rumbles.size(), 3u) << "renewed, because an effect lasts half a second";
  push(0.4, 0.0);
  EXPECT_EQ(kernel.rumbles.back(), 0);
  EXPECT_EQ(device->counters()[1], (std::pair<std::string, long long>("rumble_changes", 4)));
  device.reset();
  EXPECT_EQ(kernel.erased, 1);
  kernel.is_on = false;
}

TEST(Gamepad, a_missing_pad_is_refused) {
  const TemporaryFolder folder;
  const std::string path = (folder / "event9").string();
  expect_contains(message_of([&] { make_device(spec_of(path))->open(); }),
                  "device: input = \"" + path + "\" cannot be opened (No such file or directory)");
  EXPECT_TRUE(make_device(spec_of(path))->is_live());
}
