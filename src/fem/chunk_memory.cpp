#include "chunk_memory.h"

#include <algorithm>

#include "palpate/core/workers.h"

namespace palpate::fem {
namespace {

using Chunk = ElementChunks::Chunk;
constexpr int kNodesAhead = 24;  // prefetch distance in nodes

/// Returns the nodes that the thread working on chunk c is likely to need next; kernels prefetch them.
NodePrefetch nodes_after(const ElementChunks& chunks, int c, const BodyFields& at, const double* out) {
  const auto next = static_cast<std::size_t>(c + workers::count());
  if (next >= chunks.chunks.size()) return {};
  const Chunk& chunk = chunks.chunks[next];
  NodePrefetch nodes;
  nodes.nodes = chunks.nodes.data() + chunk.first_node;
  nodes.count = chunk.nodes;
  const int groups = groups_of(chunks, chunks.chunks[static_cast<std::size_t>(c)]);
  nodes.batch = chunk.nodes / std::max(1, groups) + 1;
  for (const double* field : {at.x, at.v, at.w, at.dv, out})
    if (field) nodes.fields[nodes.field_count++] = field;
  return nodes;
}

}  // namespace

int groups_of(const ElementChunks& chunks, const Chunk& chunk) {
  int sum = 0;
  chunks.for_each_run(chunk, [&](const ElementChunks::Run& run) { sum += run.groups; });
  return sum;
}

void BlockMemory::resize(std::size_t count) {
  first.resize(count);
  last.resize(count);
}

void ChunkMemory::fit(const ElementChunks& chunks) {
  const auto nodes = static_cast<std::size_t>(chunks.most_nodes) + 4;
  for (auto* field : {&x_, &v_, &w_, &sum_}) field->resize((nodes + 1) / 2);
}

double* ChunkMemory::zeroed_sum(const Chunk& chunk) {
  double* sum = numbers(sum_);
  std::fill_n(sum, 4 * (chunk.nodes + 4), 0.0);
  return sum;
}

ChunkFields ChunkMemory::load(const ElementChunks& chunks, int c, const BodyFields& at, const double* out) {
  const Chunk& chunk = chunks.chunks[static_cast<std::size_t>(c)];
  const int* nodes = chunks.nodes.data() + chunk.first_node;
  const auto copy = [&](const double* from, std::vector<Line>& lines, double unit,
                        const double* more = nullptr) {
    double* to = numbers(lines);
    for (int n = 0; n < chunk.nodes; ++n) {
      if (n + kNodesAhead < chunk.nodes)
        __builtin_prefetch(from + 3 * static_cast<std::size_t>(nodes[n + kNodesAhead]));
      const double* p = from + 3 * static_cast<std::size_t>(nodes[n]);
      to[4 * n] = p[0];
      to[4 * n + 1] = p[1];
      to[4 * n + 2] = p[2];
      to[4 * n + 3] = 0.0;
    }
    for (int n = 0; more && n < chunk.nodes; ++n)
      for (int axis = 0; axis < 3; ++axis)
        to[4 * n + axis] += more[3 * static_cast<std::size_t>(nodes[n]) + static_cast<std::size_t>(axis)];
    std::fill_n(to + 4 * chunk.nodes, 16, 0.0);
    for (int axis = 0; axis < 3; ++axis) to[4 * (chunk.nodes + 1 + axis) + axis] = unit;
    return static_cast<const double*>(to);
  };
  ChunkFields fields;
  fields.x = copy(at.x, x_, 1.0);
  if (at.v) fields.v = copy(at.v, v_, 0.0, at.dv);
  if (at.w) fields.w = copy(at.w, w_, 0.0);
  nodes_ = nodes_after(chunks, c, at, out);
  fields.next_nodes = &nodes_;
  return fields;
}

std::size_t ChunkMemory::bytes() const {
  std::size_t sum = 0;
  for (const auto* lines : {&x_, &v_, &w_, &sum_}) sum += bytes_of(*lines);
  for (const auto* blocks : {&upper, &lower, &diagonal}) sum += blocks->bytes();
  return sum;
}

}  // namespace palpate::fem
