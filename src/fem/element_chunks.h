#pragma once
#include <cstddef>
#include <vector>

#include "lane_kernels.h"
#include "palpate/mesh/mesh.h"
#include "rest_elements.h"

namespace palpate::fem {

/// Contributions of chunks to nodes or edges that an earlier chunk owns: entry k is the sum of the
/// contributions entries[start[k]] to entries[start[k + 1]], indices in a buffer, in the order of the chunks.
struct SharedSums {
  std::vector<int> first, second;  ///< node of the body; for edges both nodes, ascending
  std::vector<int> start{0}, entries;
  int count() const { return static_cast<int>(first.size()); }
  int contributions() const { return static_cast<int>(entries.size()); }
};

/// The tetrahedra of a body, partitioned into compact chunks and packed in groups of eight SIMD lanes.
///
/// A chunk sums forces and matrix blocks over its elements in separate memory that fits the cache. Nodes and
/// edges that no earlier chunk has are "owned": their sums go straight into the result. Others are "shared"
/// with an earlier chunk: their contributions are stored and added afterwards, in the order of the chunks; or
/// at once, where one thread processes the chunks in order. Chunks depend on the mesh alone, so the sums are
/// bitwise equal for any distribution of chunks to threads.
///
/// In a body of several materials, the elements of each chunk are sorted by material, and each material
/// begins a new group: the kernels run over the groups of one material at a time and read no more data than
/// for a body of one material, which has one such run per chunk. The cost of several materials is unused
/// lanes: at most seven per material and chunk.
class ElementChunks {
 public:
  struct Chunk {
    int first_run = 0, runs = 0;                     ///< range in `runs`
    int first_node = 0, nodes = 0, owned_nodes = 0;  ///< range in `nodes`; owned ones first
    int first_edge = 0, edges = 0, owned_edges = 0;  ///< range in `ends`; owned ones first
    /// Index of the first shared one in the buffers of contributions.
    int first_shared_node = 0, first_shared_edge = 0;
  };

  /// Consecutive groups of one material within a chunk.
  struct Run {
    int first_group = 0, groups = 0;
    int material = 0;
  };

  /// @param rest  Rest positions and tetrahedra.
  /// @param elements  Their rest shapes.
  /// @param material_of_element  Material index per element; empty: all 0.
  ElementChunks(const TetMesh& rest, const RestElements& elements,
                const std::vector<int>& material_of_element = {});

  int element_count() const { return element_count_; }
  int node_count() const { return static_cast<int>(nodal_volume.size()); }

  std::vector<ElementGroup> groups;
  std::vector<GroupEdges> edges;  ///< edges of each group
  std::vector<Chunk> chunks;
  std::vector<Run> runs;            ///< runs of each chunk, by material
  std::vector<int> nodes;           ///< node of the body for each node of each chunk
  std::vector<std::uint16_t> ends;  ///< two chunk nodes for each edge of each chunk
  /// Edges at entry n of `nodes`: row_edges[row_start[n]] to row_edges[row_start[n + 1]].
  std::vector<std::int32_t> row_start;
  std::vector<std::int32_t> row_owned;   ///< number of owned edges in each row; these come first
  std::vector<std::uint32_t> row_edges;  ///< 2 edge, plus one where the node is its second
  SharedSums shared_nodes, shared_edges;
  std::vector<double> nodal_volume;    ///< a quarter of each adjacent tetrahedron [m^3]
  int most_nodes = 0, most_edges = 0;  ///< largest numbers in a chunk

  /// One element: its index in the mesh, its material's index, its nodes in the body, ascending, the
  /// gradients g_1 to g_3 as rows in the rotated rest frame of ElementGroup, and its volume [m^3].
  struct Element {
    int number;
    int material;
    int node[4];
    Mat3 gradients;
    double volume;
    /// Returns [x1-x0, x2-x0, x3-x0] of a nodal field of the body.
    Mat3 edges(const double* field) const;
  };
  /// Calls f(Element) for each element, chunk by chunk.
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
  /// Calls f(Run) for each run of a chunk.
  template <class F>
  void for_each_run(const Chunk& chunk, F&& f) const {
    for (int r = chunk.first_run; r < chunk.first_run + chunk.runs; ++r) f(runs[static_cast<std::size_t>(r)]);
  }
  std::size_t bytes() const;

 private:
  struct Plan;
  void add_chunk(const Plan& plan, std::size_t c);
  void add_group(const Chunk& chunk);
  void fill_lane(const Plan& plan, std::size_t chunk, int e, std::size_t lane);
  void make_rows(const Chunk& chunk);
  Element element(const Chunk& chunk, const Run& run, int group, int lane) const;
  /// Index in the mesh of each lane of each group; -1 in padding lanes.
  std::vector<std::int32_t> numbers_;
  int element_count_ = 0;
};

}  // namespace palpate::fem
