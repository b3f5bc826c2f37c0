#pragma once
#include <vector>

#include "palpate/dynamics/matrix.h"

namespace palpate::integrate {

/// Nodes in clusters of nearly equal size that hang together in the matrix's graph.
struct NodeOrder {
  std::vector<int> node;   ///< the nodes, cluster after cluster
  std::vector<int> start;  ///< where each cluster begins in `node`; clusters + 1 entries
  int clusters() const { return static_cast<int>(start.size()) - 1; }
};

/// Recursive bisection by breadth-first levels (George 1973): from a node far from all others, the half that is reached first is cut off.  The cut is
/// about as small as a level of the graph.  O(nodes log clusters); needs no positions.
NodeOrder cluster_nodes(const dynamics::BlockSparse& A, int clusters);

}  // namespace palpate::integrate
