#pragma once
#include "palpate/core/error.h"
#include "palpate/dynamics/state.h"

namespace palpate::fem {

/// Location of one body's nodes in a state. It is looked up anew at each evaluation, since blocks move when
/// others are added or removed.
struct NodeBlock {
  const double* x;  ///< positions [m], three per node
  const double* v;  ///< velocities [m/s]
  int u_offset;     ///< offset in u, forces and directions
  int first_node;   ///< index over all node blocks

  NodeBlock(const dynamics::StateView& state, int block_id, int node_count) {
    const dynamics::Block* block = state.layout->find(block_id);
    PALPATE_CHECK(block && block->kind == dynamics::BlockKind::kNodes && block->u_size == 3 * node_count,
                  "block {} is not a block of {} nodes in this state", block_id, node_count);
    x = state.q.data() + block->q_offset;
    v = state.u.data() + block->u_offset;
    u_offset = block->u_offset;
    first_node = block->u_offset / 3;
  }
};

}  // namespace palpate::fem
