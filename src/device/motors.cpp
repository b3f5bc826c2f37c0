#include "palpate/device/motors.h"

#include <cmath>

#include "device/check_range.h"
#include "device/make.h"
#include "palpate/device/profile.h"

namespace palpate::device {
namespace {

Vec3 cut(const Vec3& value, double max) {
  const double norm = value.norm();
  return norm > max ? Vec3(value * (max / norm)) : value;
}

}  // namespace

Motors::Motors(const Figures& figures) : figures_(figures) { sent_.reserve(2048); }

Wrench Motors::shaped(const Wrench& wrench) const {
  return {cut(wrench.moment, figures_.max_torque),
          cut(to_step(wrench.force, figures_.force_step), figures_.max_force)};
}

void Motors::send(double t, const Wrench& wrench) {
  if (sent_.size() ==
      sent_.capacity()) {  // Discards wrenches that have taken effect, without a new allocation.
    sent_.erase(sent_.begin(), sent_.begin() + static_cast<std::ptrdiff_t>(next_));
    next_ = 0;
  }
  sent_.push_back({t + figures_.delay, shaped(wrench)});
}

void Motors::archive(Archive& a) {
  std::size_t sent = sent_.size();
  a("sent_count", sent);
  sent_.resize(sent);
  a.rows("sent", sent_, [](auto&& f, Sent& one) {
    f(one.due);
    f(one.wrench);
  });
  a("next", next_);
  a("held", held_);
  a("time", time_);
  a("started", started_);
}

Motors::Figures motor_figures(const DeviceSpec& spec) {
  check_range("force_resolution_n", spec.force_resolution_n, DeviceRanges::resolution);
  check_range("delay_s", spec.delay_s, DeviceRanges::delay_s);
  const DeviceFigures figures = figures_of(spec);
  return {spec.delay_s, spec.force_resolution_n, figures.max_force, figures.max_torque};
}

}  // namespace palpate::device
