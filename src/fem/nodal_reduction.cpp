#include "nodal_reduction.h"

namespace palpate::fem {
namespace {

constexpr int kReducedAhead = 24;  // prefetch distance in nodes

}  // namespace

void NodalReduction::fit(const ElementChunks& chunks) {
  if (!in_order()) shared_.resize((static_cast<std::size_t>(chunks.shared_nodes.contributions()) + 1) / 2);
}

void NodalReduction::add(const ElementChunks& chunks, const ElementChunks::Chunk& chunk, const double* sum,
                         double* out) {
  const int* nodes = chunks.nodes.data() + chunk.first_node;
  const int direct = in_order() ? chunk.nodes : chunk.owned_nodes;
  for (int n = 0; n < direct; ++n) {
    if (n + kReducedAhead < direct)
      __builtin_prefetch(out + 3 * static_cast<std::size_t>(nodes[n + kReducedAhead]));
    for (int axis = 0; axis < 3; ++axis)
      out[3 * static_cast<std::size_t>(nodes[n]) + static_cast<std::size_t>(axis)] += sum[4 * n + axis];
  }
  if (direct < chunk.nodes)
    std::copy_n(sum + 4 * direct, 4 * (chunk.nodes - direct),
                numbers(shared_) + 4 * static_cast<std::size_t>(chunk.first_shared_node));
}

void NodalReduction::finish(const ElementChunks& chunks, double* out) const {
  if (in_order()) return;
  const SharedSums& shared = chunks.shared_nodes;
  for_each_sum(shared.count(), [&](int k) {
    double* to = out + 3 * static_cast<std::size_t>(shared.first[static_cast<std::size_t>(k)]);
    for (int p = shared.start[static_cast<std::size_t>(k)]; p < shared.start[static_cast<std::size_t>(k) + 1];
         ++p) {
      const double* part =
          shared_.front().value + 4 * static_cast<std::size_t>(shared.entries[static_cast<std::size_t>(p)]);
      for (int axis = 0; axis < 3; ++axis) to[axis] += part[axis];
    }
  });
}

}  // namespace palpate::fem
