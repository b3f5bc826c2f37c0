#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <unordered_set>
#include <utility>
#include <vector>

#include "contact/carrier.h"
#include "palpate/dynamics/matrix.h"

namespace palpate::contact {

/// Adjacency of one body's nodes: the nodes that elements (or faces) connect to each node, including itself.
class NodeNeighbours {
 public:
  NodeNeighbours() = default;
  /// @param cells  nodes of the elements, one element per column, counted from 0  @param first  offset added
  ///   to the nodes
  NodeNeighbours(const Eigen::Ref<const Eigen::MatrixXi>& cells, int first);
  /// Returns the neighbours of a node. @pre an element contains it
  std::span<const int> of(int node) const;
  bool empty() const { return nodes_.empty(); }

 private:
  int first_ = 0;
  std::vector<int> start_, nodes_;
};

/// Node pairs that the samples couple, between two bodies or within one: blocks of the tangent that come and
/// go with the contact.
///
/// A sample's gap depends on the nodes of both its points, so that its K = A k n n^T couples each node of a
/// with each node of b (tangent.cpp). Coupling all nodes of one skin with all nodes of the other would be a
/// dense matrix. The pattern therefore contains the pairs that occurred, with the neighbours of both nodes,
/// so that a contact may slide by one element before a new pair occurs (each change costs a symbolic
/// analysis, many times the cost of the product with some more blocks). The pattern grows as contact slides
/// on; where it exceeds twice the present need, it is rebuilt.
///
/// Steps that keep the contact tangent separate from their matrix (point_operator) never request a pattern: a
/// query only records the carriers of its samples, and the pattern is built on request.
class CoupledNodes {
 public:
  /// Carriers of both points of a sample.
  struct Joint {
    std::uint64_t key = 0;  ///< Numbers of both carriers, see key_of().
    int count_a = 0, count_b = 0;
    std::array<int, 4> a{}, b{};  ///< Nodes of both carriers.
  };
  static std::uint64_t key_of(int carrier_a, int carrier_b) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(carrier_a)) << 32 |
           static_cast<std::uint32_t>(carrier_b);
  }
  /// Returns the joint of two points.
  static Joint joint_of(const CarriedPoint& a, const CarriedPoint& b) {
    return {key_of(a.number, b.number), a.point.count, b.point.count, a.point.node, b.point.node};
  }
  /// Restarts with a new numbering of the nodes. @pre both adjacencies outlive this object
  void start(const NodeNeighbours& a, const NodeNeighbours& b);
  /// Records the joints of a query.
  void take(std::span<const Joint> joints);
  /// Adds the node pairs of the pattern.
  void add_pattern(dynamics::PatternBuilder& pattern);
  std::uint64_t version();  ///< Returns a counter that increases with every change.

 private:
  using Pairs = std::vector<std::pair<int, int>>;
  template <class Visit>
  static bool for_each_pair(const Joint& joint, Visit visit);
  void catch_up();  ///< Updates the pattern with the recorded joints.
  bool holds();
  void widen();

  const NodeNeighbours *of_a_ = nullptr, *of_b_ = nullptr;
  std::vector<Joint> joints_;                // Joints of the last query.
  bool behind_ = false;                      // True: these joints were not processed yet.
  Pairs pairs_, met_, wide_, both_;          // Ascending.
  std::unordered_set<std::uint64_t> known_;  // Keys of joints whose pairs the pattern contains.
  std::uint64_t version_ = 0;
};

}  // namespace palpate::contact
