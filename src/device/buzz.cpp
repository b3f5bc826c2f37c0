#include "device/buzz.h"

#include <cmath>
#include <numbers>

#include "palpate/core/error.h"

// Butterworth high pass, fourth order: two sections s^2/(s^2 + s/Q + 1) with Q = 1/(2 cos(pi/8)) and 1/(2
// cos(3 pi/8)), s in units of the cutoff. With w = tan(pi f_c T) the bilinear transform is s = (1 - z^-1)/(w
// (1 + z^-1)):
//     H = (1 - z^-1)^2/(n (1 + a1 z^-1 + a2 z^-2)),   n = 1 + w/Q + w^2,
//     a1 = 2 (w^2 - 1)/n,   a2 = (1 - w/Q + w^2)/n.

namespace palpate::device {

VibrationMeter::Section VibrationMeter::section(double w, double q) {
  const double n = 1.0 + w / q + w * w;
  return {1.0 / n, 2.0 * (w * w - 1.0) / n, (1.0 - w / q + w * w) / n};
}

Vec3 VibrationMeter::Section::operator()(const Vec3& x) {
  const Vec3 y = c * (x - 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
  x2 = x1, x1 = x;
  y2 = y1, y1 = y;
  return y;
}

namespace {

double warped(double tick_s, double frequency_hz) {
  PALPATE_CHECK(tick_s > 0.0 && frequency_hz > 0.0 && frequency_hz * tick_s < 0.5,
                "a high-pass filter at {} Hz needs ticks shorter than half its period, not {} s",
                frequency_hz, tick_s);
  return std::tan(std::numbers::pi * frequency_hz * tick_s);
}

}  // namespace

VibrationMeter::VibrationMeter(double tick_s, double frequency_hz)
    : first_(section(warped(tick_s, frequency_hz), 0.5 / std::cos(std::numbers::pi / 8.0))),
      second_(section(warped(tick_s, frequency_hz), 0.5 / std::cos(3.0 * std::numbers::pi / 8.0))) {}

void VibrationMeter::add(const Vec3& force) {
  if (!started_) first_.x1 = first_.x2 = force;
  started_ = true;
  const Vec3 high = second_(first_(force));
  sum_ += high.squaredNorm();
  largest_ = std::max(largest_, high.norm());
  ++count_;
}

void VibrationMeter::Section::archive(Archive& a) {
  a("x1", x1);
  a("x2", x2);
  a("y1", y1);
  a("y2", y2);
}

void VibrationMeter::archive(Archive& a) {
  a("first", first_);
  a("second", second_);
  a("started", started_);
  a("sum", sum_);
  a("largest", largest_);
  a("count", count_);
}

double VibrationMeter::rms() const {
  return count_ > 0 ? std::sqrt(sum_ / static_cast<double>(count_)) : 0.0;
}

}  // namespace palpate::device
