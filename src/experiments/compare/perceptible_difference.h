#pragma once
#include <string>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::compare {

/// Weber fraction of force: smallest perceptible difference relative to the force, for fingers: 7 % of 2.5 to
/// 10 N (X. D. Pang, H. Z. Tan, N. I. Durlach: Manual discrimination of force using active finger motion.
/// Perception and Psychophysics 49, 1991).
inline constexpr double kForceWeber = 0.07;
/// Weber fraction of torque: 12.7 % of 60 N mm (L. Jandura, M. A. Srinivasan: Experiments on human
/// performance in torque discrimination and control. ASME DSC 55-1, 1994).
inline constexpr double kTorqueWeber = 0.127;
/// Magnitudes below which the threshold is constant [N], [N m]: Weber's law is not measured there, and a
/// relative threshold would vanish.
inline constexpr double kLeastForce = 0.5, kLeastTorque = 0.06;

/// Comparison of one quantity on the hand between two runs: force [N] or torque [N m].
struct WrenchSeries {
  double peak = 0.0;            ///< Peak of the reference.
  double rms = 0.0, max = 0.0;  ///< RMS and maximum of the difference.
  /// Share of the ticks with a perceptible difference.
  double noticeable = 0.0;
  /// Frequency band.
  struct Band {
    double low_hz, high_hz;
    /// RMS in the band; the squares of all bands add up to the total mean square.
    double difference, reference;
  };
  std::vector<Band> bands;  ///< Up to half of the tick rate.
};

/// Difference of two runs as perceived by the hand.
struct PerceptibleDifference {
  long ticks = 0;                   ///< Number of ticks compared.
  double from_s = 0.0, to_s = 0.0;  ///< First and last time compared [s].
  bool identical = false;           ///< Bitwise equal.
  WrenchSeries force, torque;
};

/// Compares the device wrenches of two runs at the reference's ticks; the other run is interpolated linearly
/// between its ticks.
/// @throws Error for runs without a time in common
PerceptibleDifference perceptible_difference(const std::vector<loop::TickRecord>& reference,
                                             const std::vector<loop::TickRecord>& other);

/// Returns the printed text, one line per figure.
std::string text_of(const PerceptibleDifference& difference);

}  // namespace palpate::compare
