#include "experiments/compare/perceptible_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "palpate/core/error.h"

namespace palpate::compare {
namespace {

using loop::TickRecord;

/// Edges of the bands [Hz]: voluntary motion, tremor, and frequencies that only an unstable loop or rough
/// contact excites.
constexpr std::array<double, 5> kEdges = {0.0, 10.0, 30.0, 100.0, 500.0};

Vec6 felt(const TickRecord& tick) {
  Vec6 out;
  out << tick.device.force, tick.device.moment;
  return out;
}

/// Device wrench at a time within the run, interpolated linearly between ticks.
class Wrenches {
 public:
  explicit Wrenches(const std::vector<TickRecord>& ticks) : ticks_(ticks) {}
  /// @pre times do not decrease from call to call
  Vec6 at(double t) {
    while (next_ + 1 < ticks_.size() && ticks_[next_].time < t) ++next_;
    const TickRecord& after = ticks_[next_];
    if (next_ == 0 || after.time == t) return felt(after);
    const TickRecord& before = ticks_[next_ - 1];
    const double s = (t - before.time) / (after.time - before.time);
    return (1.0 - s) * felt(before) + s * felt(after);
  }

 private:
  const std::vector<TickRecord>& ticks_;
  std::size_t next_ = 0;
};

// Mean square of x per frequency bin, by its periodogram under Hann's window w, which limits leakage of a
// tone to neighbouring bins: by Parseval, sum_k |X_k|^2 = N sum_n |w x|^2.  The window weights the middle of
// a run more than its ends, with an effect that depends on where x is large: this gain, sum |w x|^2 over the
// mean square of x, is divided out, so that the bins |X_k|^2 add up to the mean square.  The mean is kept, in
// the lowest bins.
VecX power(const VecX& x) {
  const Eigen::Index n = x.size();
  VecX windowed(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double w = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) /
                                          static_cast<double>(n));
    windowed[i] = w * x[i];
  }
  Eigen::FFT<double> fft;
  Eigen::VectorXcd spectrum;
  fft.fwd(spectrum, windowed);
  VecX out = VecX::Zero(n / 2 + 1);
  for (Eigen::Index k = 0; k < n; ++k) out[std::min(k, n - k)] += std::norm(spectrum[k]);
  if (const double whole = out.sum(); whole > 0.0) out *= x.squaredNorm() / (static_cast<double>(n) * whole);
  return out;
}

void add_bands(WrenchSeries& series, const MatX& difference, const MatX& reference, double rate) {
  const Eigen::Index n = difference.cols();
  VecX d = VecX::Zero(n / 2 + 1), r = d;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    d += power(difference.row(axis));
    r += power(reference.row(axis));
  }
  const double nyquist = 0.5 * rate;
  for (std::size_t b = 0; b < kEdges.size() && kEdges[b] < nyquist; ++b) {
    const bool last = b + 1 == kEdges.size() || kEdges[b + 1] >= nyquist;
    WrenchSeries::Band band{kEdges[b], last ? nyquist : kEdges[b + 1], 0.0, 0.0};
    for (Eigen::Index k = 0; k < d.size(); ++k) {
      const double f = rate * static_cast<double>(k) / static_cast<double>(n);
      if (f < band.low_hz || (f >= band.high_hz && !last)) continue;
      band.difference += d[k];
      band.reference += r[k];
    }
    band.difference = std::sqrt(band.difference);
    band.reference = std::sqrt(band.reference);
    series.bands.push_back(band);
  }
}

WrenchSeries series_of(const MatX& reference, const MatX& other, double rate, double weber, double least) {
  const MatX difference = other - reference;
  WrenchSeries out;
  long beyond = 0;
  for (Eigen::Index i = 0; i < difference.cols(); ++i) {
    const double d = difference.col(i).norm(), f = reference.col(i).norm();
    out.peak = std::max(out.peak, f);
    out.max = std::max(out.max, d);
    beyond += d > weber * std::max(f, least);
  }
  out.rms = std::sqrt(difference.squaredNorm() / static_cast<double>(difference.cols()));
  out.noticeable = static_cast<double>(beyond) / static_cast<double>(difference.cols());
  if (difference.cols() > 1) add_bands(out, difference, reference, rate);
  return out;
}

// Rounding error of a sum of a million terms of perceptible size, 1.1e-16 each with random signs, is 1.1e-13;
// ten times that accounts for propagation over later ticks.  Below it no relative figure is given.
constexpr double kRounding = 1e-12;

/// Returns the printed lines of one quantity.
/// @param least  magnitude below which the perception threshold is constant [unit]
std::string line_of(const char* what, const WrenchSeries& s, const char* unit, double weber, double least) {
  const bool none = s.peak <= kRounding * least;  // In the reference.
  if (none && s.max <= kRounding * least)
    return fmt::format("{}: none in either run beyond rounding (at most {:.1g} {})\n", what,
                       std::max(s.peak, s.max), unit);
  std::string out = fmt::format(
      "{}: differs by {:.4g} {} RMS ({}), at most {:.4g}; noticeable (over {:g} %) in {:.3g} % of the "
      "ticks\n",
      what, s.rms, unit,
      none ? "the reference has none"
           : fmt::format("{:.3g} % of the peak of {:.4g}", 100.0 * s.rms / s.peak, s.peak),
      s.max, 100.0 * weber, 100.0 * s.noticeable);
  for (const WrenchSeries::Band& b : s.bands)
    out += fmt::format("  {:>3g} to {:>3g} Hz: {:.3g} {} RMS{}\n", b.low_hz, b.high_hz, b.difference, unit,
                       none ? "" : fmt::format(" of {:.3g}", b.reference));
  return out;
}

}  // namespace

PerceptibleDifference perceptible_difference(const std::vector<TickRecord>& reference,
                                             const std::vector<TickRecord>& other) {
  if (reference.empty() || other.empty()) fail("a run without ticks has no force on a hand");
  std::vector<const TickRecord*> at;
  for (const TickRecord& tick : reference)
    if (tick.time >= other.front().time && tick.time <= other.back().time) at.push_back(&tick);
  if (at.empty())
    fail("the runs have no time in common: [{:g}, {:g}] and [{:g}, {:g}] s", reference.front().time,
         reference.back().time, other.front().time, other.back().time);
  PerceptibleDifference out;
  out.ticks = std::ssize(at);
  out.from_s = at.front()->time;
  out.to_s = at.back()->time;
  out.identical = reference.size() == other.size();
  MatX r(6, out.ticks), o(6, out.ticks);
  Wrenches wrenches(other);
  for (Eigen::Index i = 0; i < out.ticks; ++i) {
    const TickRecord& tick = *at[static_cast<std::size_t>(i)];
    r.col(i) = felt(tick);
    o.col(i) = wrenches.at(tick.time);
    out.identical =
        out.identical && r.col(i) == o.col(i) && other[static_cast<std::size_t>(i)].time == tick.time;
  }
  const double rate = out.ticks > 1 ? static_cast<double>(out.ticks - 1) / (out.to_s - out.from_s) : 1.0;
  out.force = series_of(r.topRows<3>(), o.topRows<3>(), rate, kForceWeber, kLeastForce);
  out.torque = series_of(r.bottomRows<3>(), o.bottomRows<3>(), rate, kTorqueWeber, kLeastTorque);
  return out;
}

std::string text_of(const PerceptibleDifference& d) {
  std::string out = fmt::format("{} ticks compared, {:g} to {:g} s{}\n", d.ticks, d.from_s, d.to_s,
                                d.identical ? ": bitwise identical" : "");
  if (d.identical) return out;
  return out + line_of("force", d.force, "N", kForceWeber, kLeastForce) +
         line_of("torque", d.torque, "N m", kTorqueWeber, kLeastTorque);
}

}  // namespace palpate::compare
