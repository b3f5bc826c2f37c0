#include "linear/mixed_precision/row_packing.h"

#include <algorithm>

#include "core/huge_pages.h"

namespace palpate::linear {
namespace {

/// Sweeps in which pairs may move to the other row.
constexpr int kRounds = 4;

struct Entry {
  int node;                ///< column
  int block, mirror = -1;  ///< block indices in the matrix; mirror: in the column's row, for a shared pair
};

}  // namespace

struct RowPacking::Row {
  int node;
  std::vector<Entry> shared, single;
};

void RowPacking::add_group(const Row* rows, int count) {
  const auto longest = [&](auto member) {
    std::size_t most = 0;
    for (int l = 0; l < count; ++l) most = std::max(most, (rows[l].*member).size());
    return most;
  };
  const auto add_step = [&](const std::vector<Entry> Row::*entries, std::size_t k) {
    for (int l = 0; l < kLanesOfGroup; ++l) {
      const Entry* entry = l < count && k < (rows[l].*entries).size() ? &(rows[l].*entries)[k] : nullptr;
      column_.push_back(4 * (entry ? entry->node : rows[l < count ? l : 0].node));
      if (!entry) continue;
      const int place = kLanesOfGroup * steps_ + l;
      place_[static_cast<std::size_t>(entry->block)] = 2 * place;
      if (entry->mirror >= 0) place_[static_cast<std::size_t>(entry->mirror)] = 2 * place + 1;
    }
    ++steps_;
  };
  for (int l = 0; l < kLanesOfGroup; ++l) row_.push_back(4 * rows[l < count ? l : 0].node);
  for (int l = 0; l < count; ++l)
    own_place_[static_cast<std::size_t>(rows[l].node)] = kLanesOfGroup * groups_ + l;
  ++groups_;
  step_start_.push_back(steps_);
  for (std::size_t k = 0, most = longest(&Row::shared); k < most; ++k) add_step(&Row::shared, k);
  single_start_.push_back(steps_);
  for (std::size_t k = 0, most = longest(&Row::single); k < most; ++k) add_step(&Row::single, k);
}

void RowPacking::analyse(const NodeOrder& order, const std::vector<int>& row_start,
                         const std::vector<int>& column) {
  for (auto* v : {&group_start_, &step_start_, &single_start_, &row_, &column_}) v->clear();
  place_.assign(column.size(), -1);
  own_place_.assign(order.node.size(), -1);
  node_start_.clear();
  for (std::size_t p = 0; p < order.part.size(); ++p) node_start_.push_back(order.first_node(p));
  steps_ = groups_ = 0;
  group_start_.push_back(0);
  std::vector<Row> rows;
  std::vector<int> taken(order.node.size(), 0);
  struct Pair {
    int low, high, block, mirror;
  };
  std::vector<Pair> pairs;
  for (std::size_t p = 0; p + 1 < node_start_.size(); ++p) {
    const int first = node_start_[p], last = node_start_[p + 1];
    rows.assign(static_cast<std::size_t>(last - first), {});
    pairs.clear();
    for (int i = first; i < last; ++i) {
      Row& row = rows[static_cast<std::size_t>(i - first)];
      const int begin = row_start[static_cast<std::size_t>(i)];
      row.node = i;
      for (int s = begin + 1; s < row_start[static_cast<std::size_t>(i) + 1]; ++s) {
        const int j = column[static_cast<std::size_t>(s)];
        if (j < first || j >= last) {
          row.single.push_back({j, s});
        } else if (j > i) {
          const auto from = column.begin() + row_start[static_cast<std::size_t>(j)];
          pairs.push_back({i, j, s,
                           static_cast<int>(
                               std::lower_bound(
                                   from + 1, column.begin() + row_start[static_cast<std::size_t>(j) + 1], i) -
                               column.begin())});
          ++taken[static_cast<std::size_t>(i)];
        }
      }
    }
    for (int round = 0; round < kRounds; ++round)
      for (Pair& pair : pairs) {
        int &mine = taken[static_cast<std::size_t>(pair.low)],
            &other = taken[static_cast<std::size_t>(pair.high)];
        if (mine <= other + 1) continue;
        --mine;
        ++other;
        std::swap(pair.low, pair.high);
        std::swap(pair.block, pair.mirror);
      }
    for (const Pair& pair : pairs)
      rows[static_cast<std::size_t>(pair.low - first)].shared.push_back({pair.high, pair.block, pair.mirror});
    std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
      return a.single.size() != b.single.size() ? a.single.size() < b.single.size()
                                                : a.shared.size() < b.shared.size();
    });
    for (std::size_t k = 0; k < rows.size(); k += kLanesOfGroup)
      add_group(rows.data() + k, static_cast<int>(std::min<std::size_t>(kLanesOfGroup, rows.size() - k)));
    group_start_.push_back(static_cast<int>(single_start_.size()));
  }
  step_start_.push_back(steps_);
  for (int& place : place_) place += 2 * kLanesOfGroup * groups_;
  for (std::size_t i = 0; i < own_place_.size(); ++i)
    place_[static_cast<std::size_t>(row_start[i])] = 2 * own_place_[i];
  constexpr int kReadAhead = 72;  // cache lines that a product prefetches past the end
  own_.assign(9 * static_cast<std::size_t>(groups_), {});
  values_.assign(9 * static_cast<std::size_t>(steps_) + kReadAhead, {});
  prefer_huge_pages(values_);
  prefer_huge_pages(column_);
}

PackedRows RowPacking::rows(std::size_t part, const float* mass) {
  return {.groups = groups_,
          .first_group = group_start_[part],
          .last_group = group_start_[part + 1],
          .first_node = node_start_[part],
          .last_node = node_start_[part + 1],
          .step_start = step_start_.data(),
          .single_start = single_start_.data(),
          .row = row_.data(),
          .column = column_.data(),
          .own = own_.front().number,
          .values = values_.front().number,
          .mass = mass};
}

}  // namespace palpate::linear
