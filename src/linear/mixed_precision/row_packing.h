#pragma once
#include <cstddef>
#include <vector>

#include "linear/mixed_precision/node_kernels.h"
#include "linear/mixed_precision/node_order.h"

namespace palpate::linear {

/// Owns the memory of PackedRows for one pattern. A block between two nodes of one part is stored once: the
/// shorter of the two rows takes it, so that rows become similar in length and little padding is needed.
/// Between parts each side stores the block, as a thread may write only to the rows of its parts.
class RowPacking {
 public:
  /// Plans the packing for a pattern.
  /// @param row_start  First block of each row, in the order's numbering.
  /// @param column  Column of each block; the diagonal block is the first of its row.
  void analyse(const NodeOrder& order, const std::vector<int>& row_start, const std::vector<int>& column);

  /// Returns the rows of one part; mass as in PackedRows.
  PackedRows rows(std::size_t part, const float* mass);
  /// Returns the number of block places, padding included.
  std::size_t places() const { return kLanesOfGroup * static_cast<std::size_t>(groups_ + steps_); }
  /// Returns the place of the k-th block of all rows; transposed() reports whether its transpose is stored
  /// there.
  std::size_t place(std::size_t block) const { return static_cast<std::size_t>(place_[block]) / 2; }
  bool transposed(std::size_t block) const { return place_[block] % 2 != 0; }
  /// Returns entry (r, c) of a block.
  float entry(std::size_t block, int r, int c) const {
    const std::size_t at = place(block) / kLanesOfGroup, own = static_cast<std::size_t>(groups_);
    return (at < own ? own_[line(at, block, r, c)] : values_[line(at - own, block, r, c)])
        .number[place(block) % kLanesOfGroup];
  }
  /// Returns a reference to entry (r, c) of a row's diagonal block.
  float& own_entry(std::size_t block, int r, int c) {
    return own_[line(place(block) / kLanesOfGroup, block, r, c)].number[place(block) % kLanesOfGroup];
  }

 private:
  struct alignas(64) Line {
    float number[kLanesOfGroup];
  };
  std::size_t line(std::size_t step, std::size_t block, int r, int c) const {
    return 9 * step + static_cast<std::size_t>(transposed(block) ? 3 * r + c : 3 * c + r);
  }
  struct Row;
  void add_group(const Row* rows, int count);

  std::vector<int> group_start_, node_start_, step_start_, single_start_, row_, column_;
  std::vector<int> place_, own_place_;
  std::vector<Line> own_, values_;
  int steps_ = 0, groups_ = 0;
};

}  // namespace palpate::linear
