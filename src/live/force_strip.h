#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "core/spsc_ring.h"
#include "palpate/core/pose.h"

namespace palpate::live {

/// Largest number of hands of a scene that can be watched.
inline constexpr std::size_t kMostHands = 8;

/// Wrench on one hand at one time.
struct StripSample {
  double time_s = 0.0;
  std::array<float, 3> force{}, torque{};  ///< World axes [N, N m].
};
/// One sample for each hand.
using StripRow = std::array<StripSample, kMostHands>;

/// Samples for a chart of the force over time: of each hand's ticks in 10 ms the one with the smallest and
/// the one with the largest force, in the order of time. A peak of a single tick is kept, and the rate is at
/// most 200 rows per second. Rows go to the server's thread without waiting and without allocation; if that
/// thread does not read for 10 s, further rows are lost.
class ForceStrip {
 public:
  static constexpr double kWidth = 0.010;            ///< Length of an interval [s].
  static constexpr std::size_t kCapacity = 1 << 11;  ///< 10 s of rows.

  explicit ForceStrip(std::size_t hands) : hands_(hands), extremes_(hands), rows_(kCapacity) {}
  /// Adds one tick of a hand. Ticks of equal time come in the order of the hands.
  void add(std::size_t hand, double time_s, const Wrench& on_hand);
  /// Removes the oldest row. Called by the reader's thread. Returns false if there is none.
  bool pop(StripRow& row) { return rows_.pop(row); }

 private:
  struct Extremes {
    StripSample least, most;
    double least_n = -1.0, most_n = -1.0;  ///< Force [N]; negative: no tick yet.
  };
  void flush();

  std::size_t hands_;
  std::vector<Extremes> extremes_;
  long interval_ = -1;
  SpscRing<StripRow> rows_;
};

}  // namespace palpate::live
