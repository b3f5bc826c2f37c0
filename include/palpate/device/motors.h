#pragma once
#include <algorithm>
#include <limits>
#include <vector>

#include "palpate/core/archive.h"
#include "palpate/core/pose.h"
#include "palpate/device/spec.h"

namespace palpate::device {

/// The wrench that a device's motors hold, from the wrenches that a loop sends: each arrives `delay` later,
/// its force rounded to steps and cut to the maximum, and is held until the next one arrives.
class Motors {
 public:
  /// Delay, resolution and limits between a loop and the hand.
  struct Figures {
    double delay = 0.0;                                           ///< [s]
    double force_step = 0.0;                                      ///< of each axis; 0: exact [N]
    double max_force = std::numeric_limits<double>::infinity();   ///< [N]
    double max_torque = std::numeric_limits<double>::infinity();  ///< [N m]
  };
  /// A wrench that the motors hold for a while.
  struct Span {
    double from, to;  ///< [s]
    Wrench wrench;    ///< on the hand
  };

  Motors() : Motors(Figures{}) {}
  /// @param figures  of the device
  explicit Motors(const Figures& figures);
  /// Rounds and cuts a wrench as the motors do.
  /// @param wrench  that a loop sends
  Wrench shaped(const Wrench& wrench) const;
  /// Sends a wrench on its way to the motors.
  /// @param t  of the sample that led to it [s], not before that of the last one
  /// @param wrench  as the loop computed it
  void send(double t, const Wrench& wrench);
  /// Advances to t and visits what was held on the way, span by span.  The first call only sets the time.
  /// @param t  [s], not before that of the last call
  /// @param f  f(const Span&)
  template <class F>
  void advance(double t, F&& f);
  /// Advances to a time.
  /// @param t  [s], not before that of the last call
  void advance(double t) {
    advance(t, [](const Span&) {});
  }
  /// Returns the mean over the last advance of the wrench that was held.
  const Wrench& mean() const { return mean_; }
  /// Visits the wrenches that are held from now on until one that is sent now arrives.
  /// @param f  f(const Span&)
  template <class F>
  void coming(F&& f) const;
  double delay() const { return figures_.delay; }  ///< [s]
  /// Keeps where it is, or resumes from there.
  /// @param a  either direction
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
  std::vector<Sent> sent_;  ///< by time; those from next_ on are on their way
  std::size_t next_ = 0;
};

/// Returns the figures of the motors of a scene's device.
/// @param spec  of the device  @throws Error for a figure out of range, naming its key
Motors::Figures motor_figures(const DeviceSpec& spec);

template <class F>
void Motors::advance(double t, F&& f) {
  const double h = started_ ? t - time_ : 0.0;
  if (h > 0.0) {
    mean_ = {};
    const double rounding = 1e-9 * h;  // ticks and delays are multiples of different decimal numbers
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
