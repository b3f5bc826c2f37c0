#include "live/timing_window.h"

#include <algorithm>
#include <cmath>

namespace palpate::live {

void TimeHistogram::add(double seconds) {
  const double position = seconds > kLeast ? kPerDecade * std::log10(seconds / kLeast) + 1.0 : 0.0;
  const int last = static_cast<int>(counts_.size()) - 1;
  ++counts_[static_cast<std::size_t>(std::clamp(static_cast<int>(std::min(position, 1e6)), 0, last))];
  ++count_;
}

double TimeHistogram::quantile(double q) const {
  long rank = std::max(1L, static_cast<long>(std::ceil(q * static_cast<double>(count_))));
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    rank -= counts_[i];
    if (rank <= 0) return i == 0 ? 0.0 : kLeast * std::pow(10.0, (static_cast<double>(i) - 0.5) / kPerDecade);
  }
  return 0.0;
}

void TimingWindow::add(double now_s, double late_s, double work_s, std::int64_t skipped) {
  if (start_s_ < 0.0) start_s_ = now_s;
  late_.add(late_s);
  work_.add(work_s);
  late_ticks_ += late_s >= tick_s_;
  last_.skipped_ticks += skipped;
  const double lasted = now_s - start_s_;
  if (lasted < 1.0) return;
  const double ticks = static_cast<double>(late_.count());
  last_.rate_hz = ticks / lasted;
  last_.late_share = static_cast<double>(late_ticks_) / ticks;
  last_.late_p99_s = late_.quantile(0.99);
  last_.work_p50_s = work_.quantile(0.5);
  last_.work_p99_s = work_.quantile(0.99);
  late_.clear();
  work_.clear();
  late_ticks_ = 0;
  start_s_ = now_s;
}

void TimingWindow::write(LiveStatus& status) const {
  status.rate_hz = last_.rate_hz;
  status.late_share = last_.late_share;
  status.late_p99_s = last_.late_p99_s;
  status.work_p50_s = last_.work_p50_s;
  status.work_p99_s = last_.work_p99_s;
  status.skipped_ticks = last_.skipped_ticks;
}

}  // namespace palpate::live
