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

/// The nodes that elements (or faces) join to each node of one body, itself among them.
class NodeNeighbours {
 public:
  NodeNeighbours() = default;
  /// @param cells  corners of an element each, nodes counted from 0  @param first  what is added to them
  NodeNeighbours(const Eigen::Ref<const Eigen::MatrixXi>& cells, int first);
  /// @pre an element has it
  std::span<const int> of(int node) const;
  bool empty() const { return nodes_.empty(); }

 private:
  int first_ = 0;
  std::vector<int> start_, nodes_;
};

/// Which nodes of one body the samples couple to which of another, or to others of its own: blocks of the
/// tangent that come and go with the contact.
///
/// A sample's gap moves with the nodes of both its points, so its K = A k n n^T couples each node of a with
/// each of b (tangent.cpp).  All nodes of one skin with all of the other would be a dense matrix: the pattern
/// holds what was met, with the neighbours of both nodes, so that contact may slide by an element before
/// anything new is met (each change costs a symbolic analysis, many times the product with some more blocks).
/// It grows as contact slides on; where it has become twice what is needed now, it starts anew.
///
/// Steps that keep contact's tangent beside their matrix (point_operator) never ask for a pattern: a query
/// only notes what its samples hang on, and the pattern is made when somebody asks.
class CoupledNodes {
 public:
  /// Carriers of both points of a sample.
  struct Joint {
    std::uint64_t key = 0;  ///< both carriers' numbers
    int count_a = 0, count_b = 0;
    std::array<int, 4> a{}, b{};  ///< nodes
  };
  static std::uint64_t key_of(int carrier_a, int carrier_b) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(carrier_a)) << 32 |
           static_cast<std::uint32_t>(carrier_b);
  }
  /// Joins two points.
  static Joint joint_of(const CarriedPoint& a, const CarriedPoint& b) {
    return {key_of(a.number, b.number), a.point.count, b.point.count, a.point.node, b.point.node};
  }
  /// The nodes are counted otherwise from now on.  @pre both are there as long as this is
  void start(const NodeNeighbours& a, const NodeNeighbours& b);
  void take(std::span<const Joint> joints);
  void add_pattern(dynamics::PatternBuilder& pattern);
  std::uint64_t version();  ///< grows with every change

 private:
  using Pairs = std::vector<std::pair<int, int>>;
  template <class Visit>
  static bool for_each_pair(const Joint& joint, Visit visit);
  void catch_up();  ///< with what was taken last
  bool holds();
  void widen();

  const NodeNeighbours *of_a_ = nullptr, *of_b_ = nullptr;
  std::vector<Joint> joints_;                // of the last query
  bool behind_ = false;                      // these were not looked at
  Pairs pairs_, met_, wide_, both_;          // ascending
  std::unordered_set<std::uint64_t> known_;  // joints, by their keys, whose pairs are there
  std::uint64_t version_ = 0;
};

}  // namespace palpate::contact
