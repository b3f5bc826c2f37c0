#pragma once
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::loop {

/// Largest force and torque on one hand, as sent to the device, and their times.
struct PeakWrench {
  double force_n = 0.0, force_at_s = 0.0;      ///< Force [N], time [s].
  double torque_n_m = 0.0, torque_at_s = 0.0;  ///< Torque about the handle's origin [N m], time [s].

  void add(const Wrench& on_hand, double time_s);
};

/// Returns the peaks of a series.  @pre as many times as wrenches
PeakWrench peak_of(const std::vector<Wrench>& on_hand, const std::vector<double>& times_s);

/// Figures of a run that only its ticks show: the peaks of the wrench on each hand.
class RunFigures : public Observer {
 public:
  void tick_of(std::size_t hand, const TickRecord& tick) override;
  void archive(Archive& a) override;

  /// Returns one entry per hand, in the numbering of scene::hands_of(); empty before the first tick.
  const std::vector<PeakWrench>& peaks() const { return peaks_; }
  /// Returns the largest force and the largest torque on any hand; zeros before the first tick.
  PeakWrench largest() const;

 private:
  std::vector<PeakWrench> peaks_;
};

}  // namespace palpate::loop
