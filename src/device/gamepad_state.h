#pragma once
#include <linux/input.h>

#include <array>

#include "palpate/device/device.h"
#include "rate_control.h"

namespace palpate::device {

/// State of a game pad as its events so far left it (linux/input.h). Sticks and triggers are numbered as in
/// the kernel's documentation of game pads: ABS_X, ABS_Y left stick, ABS_RX, ABS_RY right stick, ABS_Z and
/// ABS_RZ the triggers.
class GamepadState {
 public:
  /// Range of an axis.
  struct Span {
    std::int32_t least, most;
  };
  /// Ranges of an Xbox pad: sticks of 16 bits, triggers of 8.
  GamepadState();
  /// Sets range and value of an axis.
  void set_axis(int code, Span span, std::int32_t value);
  /// Applies one event; returns false if events were lost, so that the state must be read again.
  bool apply(const input_event& event);
  /// Returns the deflection: left stick x and y, triggers z (right up, left down), right stick turns about z
  /// (left and right) and x (forward and back).
  Deflection deflection() const;
  /// Bit i: button BTN_GAMEPAD + i is pressed.
  std::uint32_t switches() const { return switches_; }
  long long events() const { return events_; }  ///< Number of changes of axes and buttons.
  /// Releases everything.
  void release();

 private:
  static constexpr std::size_t kAxes = 6;
  double share(int code) const;  ///< Value from 0 (least) to 1 (most).
  std::array<Span, kAxes> spans_;
  std::array<std::int32_t, kAxes> values_{};
  std::uint32_t switches_ = 0;
  long long events_ = 0;
};

}  // namespace palpate::device
