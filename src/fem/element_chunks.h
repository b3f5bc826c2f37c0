#pragma once
#include <cstddef>
#include <vector>

#include "lane_kernels.h"
#include "palpate/mesh/mesh.h"
#include "rest_elements.h"

namespace palpate::fem {

/// What chunks add to nodes or edges that an earlier chunk owns: entry k gathers the contributions
/// entries[start[k]] to entries[start[k + 1]], indices in a buffer, in the order of the chunks.
struct SharedSums {
  std::vector<int> first, second;  ///< the node of the body; for edges the two nodes, ascending
  std::vector<int> start{0}, entries;
  int count() const { return static_cast<int>(first.size()); }
  int contributions() const { return static_cast<int>(entries.size()); }
};

/// The tetrahedra of a body in compact chunks, eight side by side.
///
/// A chunk sums forces and matrix blocks over its own elements in memory of its own, that fits the cache;
/// nodes and edges that no earlier chunk has are "owned" and go from there straight into the result, the
/// others are "shared" with an earlier chunk: their contributions are put aside and added afterwards, in the
/// order of the chunks; or at once, where one thread does the chunks in their order.  Chunks depend on the
/// mesh alone, so that the sums are the same to the last bit whoever computes which chunk.
///
/// A body of several materials has its elements ordered by material within each chunk, and each material
/// begins a group of its own: the kernels run over the groups of one material at a time and read nothing more
/// for it than a body of one material, which has one such run a chunk.  What the others pay is the lanes left
/// over: at most seven a material and chunk.
class ElementChunks {
 public:
  struct Chunk {
    int first_run = 0, runs = 0;                     ///< in runs()
    int first_node = 0, nodes = 0, owned_nodes = 0;  ///< in node(); owned ones first
    int first_edge = 0, edges = 0, owned_edges = 0;  ///< in ends(); owned ones first
    /// first of the shared ones in the buffers of contributions
    int first_shared_node = 0, first_shared_edge = 0;
  };

  /// Groups of one material, within one chunk.
  struct Run {
    int first_group = 0, groups = 0;
    int material = 0;
  };

  /// @param material_of_element  numbers; empty: all have the same
  ElementChunks(const TetMesh& rest, const RestElements& elements,
                const std::vector<int>& material_of_element = {});

  int element_count() const { return element_count_; }
  int node_count() const { return static_cast<int>(nodal_volume.size()); }

  std::vector<ElementGroup> groups;
  std::vector<GroupEdges> edges;  ///< of each group
  std::vector<Chunk> chunks;
  std::vector<Run> runs;            ///< of each chunk, by material
  std::vector<int> nodes;           ///< node of the body of each node of each chunk
  std::vector<std::uint16_t> ends;  ///< two nodes of the chunk for each edge of each chunk
  /// the edges at node n of nodes(): row_edges[row_start[n]] to [row_start[n + 1]]
  std::vector<std::int32_t> row_start;
  std::vector<std::int32_t> row_owned;   ///< how many of them are owned edges; these come first
  std::vector<std::uint32_t> row_edges;  ///< 2 edge, plus one where the node is its second
  SharedSums shared_nodes, shared_edges;
  std::vector<double> nodal_volume;    ///< a quarter of each adjacent tetrahedron [m^3]
  int most_nodes = 0, most_edges = 0;  ///< in a chunk

  /// One element: its number in the mesh, that of its material, its nodes in the body, ascending, the
  /// gradients g_1 to g_3 as rows, in the rotated rest frame of ElementGroup, its volume.
  struct Element {
    int number;
    int material;
    int node[4];
    Mat3 gradients;
    double volume;
    /// [x1-x0, x2-x0, x3-x0] of a nodal field of the body
    Mat3 edges(const double* field) const;
  };
  template <class F>
  void for_each(F&& f) const {
    for (const Chunk& chunk : chunks)
      for_each_run(chunk, [&](const Run& run) {
        for (int g = run.first_group; g < run.first_group + run.groups; ++g)
          for (int lane = 0; lane < ElementGroup::kLanes; ++lane)
            if (numbers_[static_cast<std::size_t>(ElementGroup::kLanes * g + lane)] >= 0)
              f(element(chunk, run, g, lane));
      });
  }
  template <class F>
  void for_each_run(const Chunk& chunk, F&& f) const {
    for (int r = chunk.first_run; r < chunk.first_run + chunk.runs; ++r) f(runs[static_cast<std::size_t>(r)]);
  }
  std::size_t bytes() const;

 private:
  void make_rows(const Chunk& chunk);
  Element element(const Chunk& chunk, const Run& run, int group, int lane) const;
  /// in the mesh, of each lane of each group; -1 in lanes that only fill up
  std::vector<std::int32_t> numbers_;
  int element_count_ = 0;
};

}  // namespace palpate::fem
