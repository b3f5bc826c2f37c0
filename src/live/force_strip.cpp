#include "live/force_strip.h"

#include <cmath>

namespace palpate::live {
namespace {

/// Ticks at the end of an interval belong to it: their times are sums that round.
constexpr double kRounding = 1e-6;

StripSample sample_of(double time_s, const Wrench& w) {
  StripSample out;
  out.time_s = time_s;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    out.force[i] = static_cast<float>(w.force[at]);
    out.torque[i] = static_cast<float>(w.moment[at]);
  }
  return out;
}

}  // namespace

void ForceStrip::add(std::size_t hand, double time_s, const Wrench& on_hand) {
  if (hand >= hands_) return;
  const long interval = static_cast<long>(std::ceil(time_s / kWidth - kRounding));
  if (hand == 0 && interval != interval_) {
    flush();
    interval_ = interval;
  }
  Extremes& e = extremes_[hand];
  const double force_n = on_hand.force.norm();
  const bool least = e.least_n < 0.0 || force_n < e.least_n, most = e.most_n < 0.0 || force_n >= e.most_n;
  if (!least && !most) return;
  const StripSample sample = sample_of(time_s, on_hand);
  if (least) e.least = sample, e.least_n = force_n;
  if (most) e.most = sample, e.most_n = force_n;
}

void ForceStrip::flush() {
  if (extremes_.empty() || extremes_[0].most_n < 0.0) return;
  StripRow first, second;
  for (std::size_t i = 0; i < hands_; ++i) {
    const Extremes& e = extremes_[i];
    const bool rises = e.least.time_s <= e.most.time_s;
    first[i] = rises ? e.least : e.most;
    second[i] = rises ? e.most : e.least;
    extremes_[i] = {};
  }
  rows_.push(first);
  rows_.push(second);
}

}  // namespace palpate::live
