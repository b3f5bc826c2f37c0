#pragma once
#include <algorithm>
#include <limits>
#include <vector>

#include "palpate/core/archive.h"
#include "palpate/core/pose.h"
#include "palpate/device/spec.h"

namespace palpate::device {

/// Model of a device's motors: each wrench that the loop sends takes effect `delay` later, with its force
/// rounded to steps and limited to the maximum, and is held until the next one takes effect.
class Motors {
 public:
  /// Delay, resolution and limits of the motors.
  struct Figures {
    double delay = 0.0;                                           ///< [s]
    double force_step = 0.0;                                      ///< Resolution per axis; 0: exact [N].
    double max_force = std::numeric_limits<double>::infinity();   ///< [N]
    double max_torque = std::numeric_limits<double>::infinity();  ///< [N m]
  };
  /// Time span with a constant wrench of the motors.
  struct Span {
    double from, to;  ///< [s]
    Wrench wrench;    ///< Wrench on the hand.
  };

  Motors() : Motors(Figures{}) {}
  /// @param figures  delay, resolution and limits of the device
  explicit Motors(const Figures& figures);
  /// Returns the wrench, rounded and limited as by the motors.
  /// @param wrench  wrench that the loop sends
  Wrench shaped(const Wrench& wrench) const;
  /// Sends a wrench to the motors.
  /// @param t  time of the sample that led to it [s], not before the time of the last call
  /// @param wrench  wrench as the loop computed it
  void send(double t, const Wrench& wrench);
  /// Advances to time t and visits the wrenches held in between, span by span. The first call only sets the
  /// time.
  /// @param t  [s], not before the time of the last call
  /// @param f  visitor f(const Span&)
  template <class F>
  void advance(double t, F&& f);
  /// Advances to time t.
  /// @param t  [s], not before the time of the last call
  void advance(double t) {
    advance(t, [](const Span&) {});
  }
  /// Returns the time average of the wrench over the last advance.
  const Wrench& mean() const { return mean_; }
  /// Visits the wrenches held from now on until a wrench sent now takes effect.
  /// @param f  visitor f(const Span&)
  template <class F>
  void coming(F&& f) const;
  double delay() const { return figures_.delay; }  ///< [s]
  /// Writes the state to an archive, or restores it.
  /// @param a  archive of either direction
  void archive(Archive& a);

 private:
  struct Sent {
    double due;
    Wrench wrench;
  };

  Figures figures_;
  double time_ = 0.0;
  bool started_ = false;
  Wrench held_, mean_;
  std::vector<Sent> sent_;  ///< By time; entries from next_ on have not taken effect yet.
  std::size_t next_ = 0;
};

/// Returns the motor parameters of a scene's device.
/// @param spec  spec of the device  @throws Error for a parameter out of range, naming its key
Motors::Figures motor_figures(const DeviceSpec& spec);

template <class F>
void Motors::advance(double t, F&& f) {
  const double h = started_ ? t - time_ : 0.0;
  if (h > 0.0) {
    mean_ = {};
    const double rounding = 1e-9 * h;  // Ticks and delays are multiples of different decimal numbers.
    for (double from = time_; from < t;) {
      for (; next_ < sent_.size() && sent_[next_].due <= from + rounding; ++next_)
        held_ = sent_[next_].wrench;
      const bool more = next_ < sent_.size() && sent_[next_].due < t - rounding;
      const Span span{from, more ? sent_[next_].due : t, held_};
      const double share = (span.to - span.from) / h;
      mean_ += {share * held_.moment, share * held_.force};
      f(span);
      from = span.to;
    }
  }
  started_ = true;
  time_ = t;
}

template <class F>
void Motors::coming(F&& f) const {
  const double arrives = time_ + figures_.delay, rounding = 1e-9 * figures_.delay;
  Span span{time_, arrives, held_};
  const auto visit = [&](double until) {
    span.to = until;
    if (span.to > span.from + rounding) f(span);
    span.from = std::max(span.from, until);
  };
  for (std::size_t i = next_; i < sent_.size() && sent_[i].due < arrives - rounding; ++i) {
    visit(sent_[i].due);
    span.wrench = sent_[i].wrench;
  }
  visit(arrives);
}

}  // namespace palpate::device
