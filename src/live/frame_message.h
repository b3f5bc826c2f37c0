#pragma once
#include <cstdint>
#include <deque>

#include "live/force_strip.h"
#include "live/frame_buffer.h"
#include "live/live_scene.h"

namespace palpate::live {

/// Rows of the strip that the server keeps for its viewers, numbered from the start of the scene.
class StripHistory {
 public:
  /// Moves all rows from the simulation here, and forgets those older than 10 s.
  void read(ForceStrip& strip);
  std::uint64_t end() const { return first_ + rows_.size(); }  ///< Number of the next row.
  std::uint64_t first() const { return first_; }               ///< Number of the oldest row.
  /// @pre first() <= number < end()
  const StripRow& row(std::uint64_t number) const { return rows_[number - first_]; }

 private:
  std::deque<StripRow> rows_;
  std::uint64_t first_ = 0;
};

/// Writes the message `frame` (docs/live.md).
/// @param hands  number of hands
/// @param next  number of the first row of the strip that the viewer has not got; becomes that of the next
void write_frame(const Frame& frame, const StripHistory& strip, std::size_t hands, std::uint64_t& next,
                 Bytes& out);

}  // namespace palpate::live
