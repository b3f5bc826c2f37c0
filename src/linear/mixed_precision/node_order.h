#pragma once
#include <vector>

#include "palpate/dynamics/matrix.h"

namespace palpate::linear {

/// Order of the nodes in clusters of nearly equal size that are connected in the matrix's graph. Adjacent
/// clusters form parts, the unit of work of one thread. Each cluster is divided into pieces, also connected;
/// where none are requested, a cluster is its only piece.
struct NodeOrder {
  std::vector<int> node;         ///< nodes, cluster by cluster, and within each cluster piece by piece
  std::vector<int> start;        ///< first index in `node` of each cluster; clusters + 1 entries
  std::vector<int> part;         ///< first cluster of each part; parts + 1 entries
  std::vector<int> piece_start;  ///< first index in `node` of each piece; pieces + 1 entries
  std::vector<int> piece;        ///< first piece of each cluster; clusters + 1 entries
  int clusters() const { return static_cast<int>(start.size()) - 1; }
  int pieces() const { return static_cast<int>(piece_start.size()) - 1; }
  int parts() const { return static_cast<int>(part.size()) - 1; }
  /// Returns the first node of part p; for p = parts(), the number of nodes.
  int first_node(std::size_t p) const { return start[static_cast<std::size_t>(part[p])]; }
};

/// Numbers of clusters, parts and pieces of an order.
struct NodeOrderSizes {
  int clusters, parts, pieces;
};
/// Returns the sizes for a coarse space on rigid clusters (rigid_mode_coarse_space.h).
NodeOrderSizes two_level_sizes(int nodes);
/// Returns the sizes where only parts are needed. They equal two_level_sizes() for all but large bodies, so
/// that one solver can take over what another was given (dynamics::CachedStep).
NodeOrderSizes one_level_sizes(int nodes);

/// Orders the nodes by recursive bisection along breadth-first levels (George 1973): starting from a
/// peripheral node, the half that is reached first is cut off. The cut is about as small as one level of the
/// graph. O(nodes log clusters); needs no positions. Bisection yields first the parts, then the clusters of
/// each part, then the pieces of each cluster.
NodeOrder cluster_nodes(const dynamics::BlockSparse& A, int clusters, int parts = 1, int pieces = 0);

}  // namespace palpate::linear
