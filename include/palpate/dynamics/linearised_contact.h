#pragma once
#include <array>
#include <cstdint>
#include <type_traits>

#include "palpate/core/pose.h"

namespace palpate::dynamics {

/// Contact wrench on the tool, linearised in time, pose and twist: F = F0 + (t - time) F1 + J dx + B (v -
/// v0), dx = pose_difference(x0, x). F1 is the rate of the wrench due to the motion of the bodies while the
/// tool is at rest. Wrenches are (moment about the tool's origin, force), other 6-vectors (angular, linear),
/// in world axes.
struct LinearisedContact {
  std::uint64_t version = 0;                      ///< Increases with each record; 0: none yet.
  double time = 0.0;                              ///< Time of x0 [s].
  std::array<double, 7> x0{1, 0, 0, 0, 0, 0, 0};  ///< Pose of linearisation: qw qx qy qz px py pz.
  std::array<double, 6> v0{};                     ///< Twist at x0 [rad/s, m/s].
  std::array<double, 6> F0{};                     ///< Wrench at x0 and v0 [N m, N].
  std::array<double, 6> F1{};                     ///< Rate of the wrench [N m/s, N/s].
  /// dF/dx, row-major [N/m, N m/rad, mixed]; negative definite for a stable contact.
  std::array<double, 36> J{};
  std::array<double, 36> B{};  ///< dF/dv, row-major.
  /// How a record is made: `exchange.linearisation` of a scene. kNone: there is no contact.
  enum class Source : int { kNone, kFrozen, kCondensed, kPoints };
  Source source = Source::kNone;  ///< How this record was made.
  int samples = 0;                ///< Number of contact samples it was made from.
};
static_assert(std::is_trivially_copyable_v<LinearisedContact>);

/// Sets the time [s], pose and twist about which a record is linear.
void set_reference(LinearisedContact& record, double t, const Pose& pose, const Twist& twist);

/// Evaluates the linearised wrench (moment, force) at a time, pose and twist [N m, N]; zero for
/// Source::kNone.
Vec6 contact_wrench(const LinearisedContact& record, double t, const Pose& pose, const Twist& twist);

}  // namespace palpate::dynamics
