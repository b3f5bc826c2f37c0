#pragma once
#include <string>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::compare {

/// Smallest difference of a force that fingers notice, over the force (Weber fraction): 7 % of 2.5 to 10 N
/// (X. D. Pang, H. Z. Tan, N. I. Durlach: Manual discrimination of force using active finger motion.
/// Perception and Psychophysics 49, 1991).
inline constexpr double kForceWeber = 0.07;
/// Of a torque: 12.7 % of 60 N mm (L. Jandura, M. A. Srinivasan: Experiments on human performance in torque
/// discrimination and control. ASME DSC 55-1, 1994).
inline constexpr double kTorqueWeber = 0.127;
/// Below these the threshold is held constant [N], [N m]: Weber's law is not measured there, and a share of
/// nothing is nothing.
inline constexpr double kLeastForce = 0.5, kLeastTorque = 0.06;

/// One quantity on the hand, of two runs: force [N] or torque [N m].
struct FeltSeries {
  double peak = 0.0;            ///< largest of the reference
  double rms = 0.0, max = 0.0;  ///< of the difference
  /// Share of the ticks whose difference a hand could notice.
  double noticeable = 0.0;
  struct Band {
    double low_hz, high_hz;
    double difference, reference;  ///< root mean square in it; the squares of all bands add up to the whole's
  };
  std::vector<Band> bands;  ///< up to half of the ticks' rate
};

struct FeltDifference {
  long ticks = 0;                   ///< compared
  double from_s = 0.0, to_s = 0.0;  ///< between these times
  bool identical = false;           ///< each to the last bit
  FeltSeries force, torque;
};

/// What a hand feels of the reference, against another run: device wrenches at the reference's ticks, the
/// other's straight between its own.
/// @throws Error for runs without a time in common
FeltDifference felt_difference(const std::vector<loop::TickRecord>& reference,
                               const std::vector<loop::TickRecord>& other);

/// In words and figures, one line each, as it is printed.
std::string text_of(const FeltDifference& difference);

}  // namespace palpate::compare
