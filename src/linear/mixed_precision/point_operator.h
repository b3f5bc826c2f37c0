#pragma once
#include <vector>

#include "linear/mixed_precision/node_order.h"
#include "palpate/dynamics/point_stiffness.h"

namespace palpate::linear {

/// A PointStiffness as an operator beside a packed matrix, in its units (times a power of two) and in the
/// order's numbering: products with vectors of four numbers a node, row ranges of one part at a time.
///
/// A sum that touches several parts is computed in each of them, and written by each to its own rows: parts
/// need no barrier, and results do not depend on the number of threads.  Its cost is that of a few hundred
/// numbers each; contact has some hundred sums where a body has 60,000 blocks.
class PointOperator {
 public:
  /// @param place_of_node  in the order's numbering  @param scale  of the packed matrix
  void take(const dynamics::PointStiffness& points, const std::vector<int>& place_of_node,
            const NodeOrder& order, double scale);
  void clear();
  bool empty() const { return along_.empty() && points_.empty(); }

  /// q += C p on the rows of a part, C in single precision; returns the part's share of p . C p.
  double product(std::size_t part, const float* p, float* q) const;
  /// y += C x on the rows of a part, unscaled and in double.
  void product(std::size_t part, const double* x, double* y) const;

  /// What it adds to diagonal blocks, each node once.
  struct Diagonal {
    int node;
    Eigen::Matrix3f block;
  };
  const std::vector<Diagonal>& diagonal() const { return diagonal_; }

  /// visit(node i, node j, block C_ij) for all pairs of nodes of all sums; a pair may come several times.
  template <class Visit>
  void for_each_block(Visit&& visit) const {
    for (const Along& a : along_)
      for (int i = 0; i < a.nodes.count; ++i)
        for (int j = 0; j < a.nodes.count; ++j)
          visit(a.nodes.place[i], a.nodes.place[j],
                Eigen::Matrix3f(a.G[kMost * i + j] * a.normal * a.normal.transpose()));
    for (const Point& a : points_)
      for (int i = 0; i < a.nodes.count; ++i)
        for (int j = 0; j < a.nodes.count; ++j)
          visit(a.nodes.place[i], a.nodes.place[j], Eigen::Matrix3f(a.weight[i] * a.weight[j] * a.C));
  }

 private:
  static constexpr int kMost = dynamics::PointStiffness::kMostNodes;
  struct Nodes {
    int count;
    bool relative;
    int place[kMost];
  };
  struct Along {
    Nodes nodes;
    Eigen::Vector3f normal;
    float G[kMost * kMost];
  };
  struct Point {
    Nodes nodes;
    float weight[kMost];
    Eigen::Matrix3f C;
  };
  Nodes placed(const dynamics::PointStiffness::Nodes& nodes, const std::vector<int>& place_of_node) const;
  void find_parts(const NodeOrder& order);
  void sum_diagonal();

  std::vector<Along> along_;
  std::vector<Point> points_;
  dynamics::PointStiffness doubles_;  ///< nodes in the order's numbering
  std::vector<int> first_node_;       ///< of each part, and behind the last
  std::vector<std::vector<int>> along_of_part_, points_of_part_;
  std::vector<Diagonal> diagonal_;
  std::vector<int> diagonal_of_node_;  ///< index, -1: none
};

}  // namespace palpate::linear
