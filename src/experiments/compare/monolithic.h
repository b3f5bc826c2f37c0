#pragma once
#include <atomic>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "loop/haptic_record.h"
#include "palpate/experiments/trajectory.h"

namespace palpate::compare {

/// Scene with tool and bodies as one system, with the integrator and contact refresh of `[compare.haptic]`.
struct MonolithicScene {
  scene::Description description;
  std::string made_by;  ///< Description for reports.
};
/// Makes the monolithic scene.
/// @param coarser  factor on step and refresh period of the keys; the tolerance is multiplied by
///   coarser^log2(10), ten for 2.  Above 1, the integrator is the check's.
MonolithicScene monolithic_scene(const scene::Description& description, double coarser = 1.0);

/// A peak force below this is rounding [N]: that of a coupling of 1e4 N/m between coordinates of a metre.  A
/// torque that is rounding (core/rounding.h) has the peak zero.  A scene without torque has no relative
/// torque error, and no order.
inline constexpr double kLeastPeak = 1e-12;

/// Returns the error relative to the peak; NaN where the peak is at most kLeastPeak.
inline double share_of_peak(double error, double peak) {
  return peak > kLeastPeak ? error / peak : std::numeric_limits<double>::quiet_NaN();
}

/// Error of the wrench on one hand.
struct HandError {
  TrajectoryError error = no_distance();
  double peak_force_n = 0.0, peak_torque_n_m = 0.0;  ///< Peaks of the reference.
  double torque_rounding_n_m = 0.0;  ///< Torque that rounding can leave; a smaller peak counts as 0.
};

/// Result of comparing a completed run with a reference under the same hand motion; the inherited members
/// refer to the first hand.
struct AgainstReference : HandError {
  std::string made_by;  ///< Description of the reference.
  /// The reference was driven by the recorded hands instead of the scene's prescribed paths.
  bool recorded_hand = false;
  double cpu_s = 0.0;                 ///< CPU time of the reference [s].
  std::vector<HandError> more_hands;  ///< Errors of each [[hand]].
  bool stopped = false;
  std::string trouble{};  ///< Reason why there is no error.
};
/// Repeats a run with monolithic_scene().  For a run in real time, and for a hand without a prescribed path,
/// the recorded hands drive the reference.
/// @param world  World of the run
/// @param records  records of each hand
/// @param real_time  whether the run was in real time
/// @throws Error as refuse_against_monolithic()
AgainstReference against_monolithic(const loop::World& world, const std::vector<loop::HapticRecord>& records,
                                    bool real_time, const std::function<void(double)>& progress,
                                    const std::atomic<bool>* stop);
/// Repeats a run in real time in virtual time, with the recorded hands and all ticks: the error that skipped
/// ticks caused.
AgainstReference against_every_tick(const loop::World& world, const std::vector<loop::HapticRecord>& records,
                                    const std::function<void(double)>& progress,
                                    const std::atomic<bool>* stop);
/// Checks that a scene has a monolithic counterpart.  @throws Error for a scene without a tool or without
/// bodies, and for one that is monolithic itself
void refuse_against_monolithic(const scene::Description& description);

}  // namespace palpate::compare
