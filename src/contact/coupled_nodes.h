#pragma once
#include <cstdint>
#include <span>
#include <unordered_set>
#include <utility>
#include <vector>

#include "contact/sample_cells.h"
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
class CoupledNodes {
 public:
  /// @param first  of the cells that these bodies have made
  void take(const SampleCells& samples, std::size_t first, const NodeNeighbours& a, const NodeNeighbours& b);
  void forget();  ///< the nodes are counted otherwise from now on
  void add_pattern(dynamics::PatternBuilder& pattern) const;
  std::uint64_t version() const { return version_; }  ///< grows with every change

 private:
  using Pairs = std::vector<std::pair<int, int>>;
  template <class Visit>
  static bool for_each_pair(const Carrier& a, const Carrier& b, Visit visit);
  bool holds(const SampleCells& samples, std::size_t first);
  void widen(const NodeNeighbours& a, const NodeNeighbours& b);

  Pairs pairs_, met_, wide_, both_;          // ascending
  std::unordered_set<std::uint64_t> known_;  // cells, by their carriers, whose pairs are there
  std::uint64_t version_ = 0;
};

}  // namespace palpate::contact
