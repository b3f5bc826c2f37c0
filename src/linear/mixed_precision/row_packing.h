#pragma once
#include <cstddef>
#include <vector>

#include "linear/mixed_precision/node_kernels.h"
#include "linear/mixed_precision/node_order.h"

namespace palpate::linear {

/// Memory of PackedRows for one pattern.  A block between two nodes of one part serves both: the shorter of
/// their rows takes it, so that rows become alike in length and little is filled up.  Between parts each side
/// has its own, as no one else may write to its rows.
class RowPacking {
 public:
  /// @param row_start, column  of the matrix in the order of its nodes, each row's own block first
  void analyse(const NodeOrder& order, const std::vector<int>& row_start, const std::vector<int>& column);

  /// The rows of one part.
  PackedRows rows(std::size_t part, const float* mass);
  /// Blocks that have room, those that fill up included.
  std::size_t places() const { return kLanesOfGroup * static_cast<std::size_t>(groups_ + steps_); }
  /// Where the k-th block of all rows, one after the other, has its place; and whether it is the transposed
  /// one that is there.
  std::size_t place(std::size_t block) const { return static_cast<std::size_t>(place_[block]) / 2; }
  bool transposed(std::size_t block) const { return place_[block] % 2 != 0; }
  /// Entry (r, c) of it.
  float entry(std::size_t block, int r, int c) const {
    const std::size_t at = place(block) / kLanesOfGroup, own = static_cast<std::size_t>(groups_);
    return (at < own ? own_[line(at, block, r, c)] : values_[line(at - own, block, r, c)])
        .number[place(block) % kLanesOfGroup];
  }
  /// The place of a row's own block.
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
