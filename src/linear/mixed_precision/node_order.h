#pragma once
#include <vector>

#include "palpate/dynamics/matrix.h"

namespace palpate::linear {

/// Nodes in clusters of nearly equal size that hang together in the matrix's graph, and these in parts, whose
/// clusters lie side by side: what one thread works on at a time.
/// A cluster has pieces, which hang together too; where none are asked for it is its only one.
struct NodeOrder {
  std::vector<int> node;         ///< the nodes, cluster after cluster and in each of them piece after piece
  std::vector<int> start;        ///< where each cluster begins in `node`; clusters + 1 entries
  std::vector<int> part;         ///< the first cluster of each part; parts + 1 entries
  std::vector<int> piece_start;  ///< where each piece begins in `node`; pieces + 1 entries
  std::vector<int> piece;        ///< the first piece of each cluster; clusters + 1 entries
  int clusters() const { return static_cast<int>(start.size()) - 1; }
  int pieces() const { return static_cast<int>(piece_start.size()) - 1; }
  int parts() const { return static_cast<int>(part.size()) - 1; }
  /// First node of a part; of the part behind the last, the number of nodes.
  int first_node(std::size_t p) const { return start[static_cast<std::size_t>(part[p])]; }
};

/// How many of each.
struct NodeOrderSizes {
  int clusters, parts, pieces;
};
/// For a coarse space on rigid clusters (rigid_mode_coarse_space.h).
NodeOrderSizes two_level_sizes(int nodes);
/// For parts alone; of all but large bodies the same, so that what one solver was given another can take
/// (dynamics::KeptStep).
NodeOrderSizes one_level_sizes(int nodes);

/// Recursive bisection by breadth-first levels (George 1973): from a node far from all others, the half that
/// is reached first is cut off.  The cut is about as small as a level of the graph.  O(nodes log clusters);
/// needs no positions.  First into parts, then each part into its share of the clusters, then each cluster
/// into its share of the pieces.
NodeOrder cluster_nodes(const dynamics::BlockSparse& A, int clusters, int parts = 1, int pieces = 0);

}  // namespace palpate::linear
