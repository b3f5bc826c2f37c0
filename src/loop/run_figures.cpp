#include "run_figures.h"

#include "palpate/core/error.h"

namespace palpate::loop {

void PeakWrench::add(const Wrench& on_hand, double time_s) {
  if (const double n = on_hand.force.norm(); n > force_n) force_n = n, force_at_s = time_s;
  if (const double n_m = on_hand.moment.norm(); n_m > torque_n_m) torque_n_m = n_m, torque_at_s = time_s;
}

PeakWrench peak_of(const std::vector<Wrench>& on_hand, const std::vector<double>& times_s) {
  PALPATE_CHECK(on_hand.size() == times_s.size(), "{} wrenches at {} times", on_hand.size(), times_s.size());
  PeakWrench peak;
  for (std::size_t i = 0; i < on_hand.size(); ++i) peak.add(on_hand[i], times_s[i]);
  return peak;
}

void RunFigures::tick_of(std::size_t hand, const TickRecord& tick) {
  if (hand >= peaks_.size()) peaks_.resize(hand + 1);
  peaks_[hand].add(tick.device, tick.time);
}

void RunFigures::archive(Archive& a) {
  a.list("peak", peaks_, [&](PeakWrench& p) {
    a("force_n", p.force_n);
    a("force_at_s", p.force_at_s);
    a("torque_n_m", p.torque_n_m);
    a("torque_at_s", p.torque_at_s);
  });
}

PeakWrench RunFigures::largest() const {
  PeakWrench out;
  for (const PeakWrench& p : peaks_) {
    if (p.force_n > out.force_n) out.force_n = p.force_n, out.force_at_s = p.force_at_s;
    if (p.torque_n_m > out.torque_n_m) out.torque_n_m = p.torque_n_m, out.torque_at_s = p.torque_at_s;
  }
  return out;
}

}  // namespace palpate::loop
