#include "gamepad_state.h"

namespace palpate::device {
namespace {

bool is_trigger(std::size_t axis) { return axis == ABS_Z || axis == ABS_RZ; }

}  // namespace

GamepadState::GamepadState() {
  for (std::size_t i = 0; i < kAxes; ++i) spans_[i] = is_trigger(i) ? Span{0, 255} : Span{-32768, 32767};
}

void GamepadState::set_axis(int code, Span span, std::int32_t value) {
  const auto axis = static_cast<std::size_t>(code);
  if (code < 0 || axis >= kAxes || span.most <= span.least) return;
  spans_[axis] = span;
  values_[axis] = value;
}

bool GamepadState::apply(const input_event& event) {
  constexpr int kButtons = 16;
  if (event.type == EV_SYN) return event.code != SYN_DROPPED;
  if (event.type == EV_ABS && event.code < kAxes) {
    values_[event.code] = event.value;
    ++events_;
  }
  if (event.type == EV_KEY && event.code >= BTN_GAMEPAD && event.code < BTN_GAMEPAD + kButtons) {
    const std::uint32_t bit = std::uint32_t{1} << (event.code - BTN_GAMEPAD);
    switches_ = event.value != 0 ? switches_ | bit : switches_ & ~bit;
    ++events_;
  }
  return true;
}

double GamepadState::share(int code) const {
  const auto axis = static_cast<std::size_t>(code);
  const auto [least, most] = spans_[axis];
  return (static_cast<double>(values_[axis]) - least) / (static_cast<double>(most) - least);
}

Deflection GamepadState::deflection() const {
  const auto stick = [this](int code) { return 2.0 * share(code) - 1.0; };
  // Sticks report y towards the user as positive.
  return {{stick(ABS_X), -stick(ABS_Y), share(ABS_RZ) - share(ABS_Z)}, {stick(ABS_RY), 0.0, -stick(ABS_RX)}};
}

void GamepadState::release() {
  for (std::size_t i = 0; i < kAxes; ++i)
    values_[i] = is_trigger(i) ? spans_[i].least : spans_[i].least + (spans_[i].most - spans_[i].least) / 2;
  switches_ = 0;
}

}  // namespace palpate::device
