#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "linear/bent_beam.h"
#include "linear/mixed_precision/node_order.h"
#include "linear/mixed_precision/row_packing.h"

namespace palpate {
namespace {

using namespace dynamics;

TEST(NodeOrder, CutsAGraphIntoEqualPartsThatHangTogether) {
  BentBeam beam(16, 1e5);
  BorderedMatrix A;
  VecX b;
  beam.at(0.0, 1e-2, A, b);
  const int n = A.body.block_rows();
  for (const int clusters : {1, 2, 7, 20}) {
    const linear::NodeOrder order = linear::cluster_nodes(A.body, clusters);
    ASSERT_EQ(order.clusters(), clusters);
    std::vector<int> seen(static_cast<std::size_t>(n), 0);
    for (const int i : order.node) ++seen[static_cast<std::size_t>(i)];
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), n);
    for (int c = 0; c < clusters; ++c)
      EXPECT_NEAR(order.start[static_cast<std::size_t>(c) + 1] - order.start[static_cast<std::size_t>(c)],
                  n / clusters, 5);
    EXPECT_EQ(order.parts(), 1);
    const linear::NodeOrder parted = linear::cluster_nodes(A.body, clusters, 4);
    EXPECT_EQ(parted.clusters(), clusters);
    EXPECT_EQ(parted.parts(), std::min(clusters, 4));
    EXPECT_EQ(parted.first_node(static_cast<std::size_t>(parted.parts())), n);
    for (std::size_t p = 0; p < static_cast<std::size_t>(parted.parts()); ++p)
      EXPECT_NEAR(parted.first_node(p + 1) - parted.first_node(p), n / parted.parts(), 2);
  }
  EXPECT_EQ(linear::cluster_nodes(A.body, 10 * n).clusters(), n) << "no more clusters than nodes";
}

// Every block has its place, or shares that of its mirror image if both nodes are in one part; little padding
// is added.
TEST(RowPacking, TakesEveryBlockOnce) {
  BentBeam beam(24, 1e5);
  const BlockSparse& pattern = beam.pattern();
  const std::size_t n = static_cast<std::size_t>(pattern.block_rows());
  for (const int parts : {1, 2, 5}) {
    const linear::NodeOrder order = linear::cluster_nodes(pattern, parts, parts);
    std::vector<int> place(n), row_start(1, 0), column, part(n);
    for (std::size_t k = 0; k < n; ++k) place[static_cast<std::size_t>(order.node[k])] = static_cast<int>(k);
    for (std::size_t p = 0; p < static_cast<std::size_t>(parts); ++p)
      std::fill(part.begin() + order.first_node(p), part.begin() + order.first_node(p + 1),
                static_cast<int>(p));
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = static_cast<std::size_t>(order.node[k]);
      column.push_back(static_cast<int>(k));
      const std::size_t first = column.size();
      for (int s = pattern.row_start()[i]; s < pattern.row_start()[i + 1]; ++s)
        if (pattern.columns()[static_cast<std::size_t>(s)] != static_cast<int>(i))
          column.push_back(place[static_cast<std::size_t>(pattern.columns()[static_cast<std::size_t>(s)])]);
      std::sort(column.begin() + static_cast<std::ptrdiff_t>(first), column.end());
      row_start.push_back(static_cast<int>(column.size()));
    }
    linear::RowPacking packing;
    packing.analyse(order, row_start, column);
    std::vector<int> taken(packing.places(), 0);
    std::size_t blocks = 0;
    for (std::size_t i = 0; i < n; ++i)
      for (auto s = static_cast<std::size_t>(row_start[i]); s < static_cast<std::size_t>(row_start[i + 1]);
           ++s) {
        const auto j = static_cast<std::size_t>(column[s]);
        const linear::PackedRows rows =
            packing.rows(static_cast<std::size_t>(part[packing.transposed(s) ? j : i]), nullptr);
        const std::size_t own = linear::kLanesOfGroup * static_cast<std::size_t>(rows.groups);
        EXPECT_EQ(packing.place(s) < own, i == j) << "own blocks first";
        EXPECT_EQ(i == j ? rows.row[packing.place(s)] : rows.column[packing.place(s) - own],
                  static_cast<int>(4 * (packing.transposed(s) ? i : j)));
        if (packing.transposed(s)) {
          EXPECT_EQ(part[i], part[j]);
          continue;
        }
        ++taken[packing.place(s)];
        ++blocks;
      }
    EXPECT_EQ(*std::max_element(taken.begin(), taken.end()), 1);
    EXPECT_EQ(static_cast<std::size_t>(std::count(taken.begin(), taken.end(), 1)), blocks);
    if (parts == 1) { EXPECT_EQ(blocks, (column.size() - n) / 2 + n) << "every pair shares"; }
    EXPECT_LT(static_cast<double>(packing.places()), 1.25 * static_cast<double>(blocks));
  }
}

}  // namespace
}  // namespace palpate
