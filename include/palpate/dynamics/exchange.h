#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
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

/// Lock-free exchange of records between one writer thread and one reader thread. The reader always receives
/// a complete record and never waits (triple buffer: the writer fills its back slot and swaps it with the
/// middle one).
template <class Record>
class Exchange {
  static_assert(std::is_trivially_copyable_v<Record>);

 public:
  /// Publishes a copy of the record as the newest one. Called by the writer's thread only.
  void publish(const Record& record) {
    slots_[back_] = record;
    back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }
  /// Returns the newest record published so far. Called by the reader's thread only; the reference is valid
  /// until the next call.
  const Record& latest() {
    if (middle_.load(std::memory_order_relaxed) & kFresh)
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return slots_[front_];
  }

 private:
  static constexpr unsigned kFresh = 4, kIndex = 3;
  std::array<Record, 3> slots_{};
  unsigned back_ = 0;
  std::atomic<unsigned> middle_{1};
  unsigned front_ = 2;
};

}  // namespace palpate::dynamics
