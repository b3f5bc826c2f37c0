#include "element_chunks.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>

#include <Eigen/LU>
#include <Eigen/QR>

#include "core/huge_pages.h"
#include "mesh/spatial_order.h"
#include "palpate/core/error.h"

namespace palpate::fem {
namespace {

/// Most and least elements per chunk. The blocks of a chunk then fit a second-level cache; smaller chunks
/// share more of their edges, but a mesh of some ten thousand elements should still yield several chunks for
/// each of a few threads.
constexpr int kMostElements = 4096, kLeastElements = 1024, kChunksToShare = 8;
int chunks_of(int elements) {
  const auto parts = [&](int size) { return (elements + size - 1) / size; };
  return std::max({1, parts(kMostElements), std::min(kChunksToShare, parts(kLeastElements))});
}
constexpr std::size_t kLanes = ElementGroup::kLanes;

using Corners = std::array<int, 4>;
constexpr int kEdgeCorners[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

std::uint64_t key_of(int i, int j) {
  return (static_cast<std::uint64_t>(i) << 32) | static_cast<std::uint32_t>(j);
}

/// Divides [begin, end) of `order` into `chunks` compact parts of nearly equal size by recursive bisection
/// across the longest side of the centroids' bounding box.
void bisect(const Points& centroids, std::vector<int>& order, int begin, int end, int chunks,
            std::vector<int>& starts) {
  if (chunks <= 1) {
    starts.push_back(end);
    return;
  }
  const int left = chunks / 2;
  const auto share = static_cast<std::int64_t>(end - begin) * left / chunks;
  const int middle = std::min(end, begin + static_cast<int>((share + 7) / 8 * 8));
  mesh::cut_across_longest(centroids, order, begin, end, middle);
  bisect(centroids, order, begin, middle, left, starts);
  bisect(centroids, order, middle, end, chunks - left, starts);
}

/// Nodes or edges used in each chunk, owned ones first, and the sums over chunks of the shared ones.
struct Uses {
  /// Ascending, then partitioned: owned ascending, shared ascending.
  std::vector<std::vector<std::uint64_t>> by_chunk;
  std::vector<int> owned;
  std::vector<int> first_shared;
  std::vector<std::uint64_t> shared;  ///< ascending, each once
  std::vector<int> start{0}, entries;

  explicit Uses(std::vector<std::vector<std::uint64_t>> used) : by_chunk(std::move(used)) {
    std::vector<std::uint64_t> all;
    for (auto& keys : by_chunk) {
      std::sort(keys.begin(), keys.end());
      keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
      all.insert(all.end(), keys.begin(), keys.end());
    }
    std::sort(all.begin(), all.end());
    for (std::size_t k = 0; k + 1 < all.size(); ++k)
      if (all[k] == all[k + 1] && (shared.empty() || shared.back() != all[k])) shared.push_back(all[k]);
    std::vector<std::vector<int>> contributions(shared.size());
    std::vector<char> met(shared.size(), 0);
    int place = 0;
    for (auto& keys : by_chunk) {
      const auto middle = std::stable_partition(keys.begin(), keys.end(), [&](std::uint64_t key) {
        const auto it = std::lower_bound(shared.begin(), shared.end(), key);
        return it == shared.end() || *it != key ||
               !std::exchange(met[static_cast<std::size_t>(it - shared.begin())], 1);
      });
      owned.push_back(static_cast<int>(middle - keys.begin()));
      first_shared.push_back(place);
      for (auto it = middle; it != keys.end(); ++it)
        contributions[static_cast<std::size_t>(std::lower_bound(shared.begin(), shared.end(), *it) -
                                               shared.begin())]
            .push_back(place++);
    }
    for (const auto& places : contributions) {
      entries.insert(entries.end(), places.begin(), places.end());
      start.push_back(static_cast<int>(entries.size()));
    }
  }
  /// Returns the index of a key within a chunk.
  int find(std::size_t chunk, std::uint64_t key) const {
    const auto& keys = by_chunk[chunk];
    const auto middle = keys.begin() + owned[chunk];
    auto it = std::lower_bound(keys.begin(), middle, key);
    if (it == middle || *it != key) it = std::lower_bound(middle, keys.end(), key);
    PALPATE_CHECK(it != keys.end() && *it == key, "key {} is not in chunk {}", key, chunk);
    return static_cast<int>(it - keys.begin());
  }
};

/// Returns the corners of an element, ascending by node.
Corners sorted_corners(const RestElements& elements, std::size_t e) {
  Corners corners{0, 1, 2, 3};
  std::sort(corners.begin(), corners.end(), [&](int a, int b) {
    return elements.node[static_cast<std::size_t>(a)][e] < elements.node[static_cast<std::size_t>(b)][e];
  });
  return corners;
}

/// Fills a padding lane: a unit tetrahedron at rest on four extra nodes after those of the chunk, with zero
/// volume, so that it adds zeros there.
void fill_up(ElementGroup& group, GroupEdges& edges, std::size_t lane, int chunk_nodes, int chunk_edges) {
  constexpr double kUnit[6] = {1.0, 0.0, 0.0, 1.0, 0.0, 1.0};
  for (int k = 0; k < 6; ++k) group.inverse_edges[k][lane] = kUnit[k];
  group.volume[lane] = 0.0;
  for (int a = 0; a < 4; ++a) group.node[a][lane] = static_cast<std::uint16_t>(chunk_nodes + a);
  for (auto& edge : edges.edge) edge[lane] = static_cast<std::uint16_t>(chunk_edges);
}

/// Returns T^-1 for the rest edges Dm = Q T, Q a rotation. T is accurate as a factor of Dm^T Dm (Householder
/// QR), and the inverse of a triangular matrix is accurate entry by entry.
Mat3 inverse_triangle(const Mat3& Dm) {
  const Eigen::HouseholderQR<Mat3> qr(Dm);
  Mat3 T = qr.matrixQR().triangularView<Eigen::Upper>();
  for (int r = 0; r < 2; ++r)
    if (T(r, r) < 0.0) T.row(r) *= -1.0;
  if ((T(2, 2) < 0.0) != (Dm.determinant() < 0.0)) T(2, 2) *= -1.0;  // Q must not be a reflection
  return T.triangularView<Eigen::Upper>().solve(Mat3::Identity());
}

}  // namespace

/// Contents of the chunks: the elements in their order, by chunk and then by material, and the nodes and
/// edges that each chunk uses.
struct ElementChunks::Plan {
  const TetMesh& rest;
  const RestElements& elements;
  const std::vector<int>& material_of_element;
  std::vector<int> starts{0}, order;  ///< first element of each chunk in `order`; elements
  Uses nodes, edges;

  Plan(const TetMesh& mesh, const RestElements& shapes, const std::vector<int>& materials)
      : rest(mesh),
        elements(shapes),
        material_of_element(materials),
        order(sorted_elements()),
        nodes(keys([&](const Corners& corners, int e, auto& out) {
          for (int corner : corners) out.push_back(static_cast<std::uint64_t>(node(corner, e)));
        })),
        edges(keys([&](const Corners& corners, int e, auto& out) {
          for (const auto& edge : kEdgeCorners) out.push_back(edge_key(corners, edge, e));
        })) {}

  int material(int e) const {
    return material_of_element.empty() ? 0 : material_of_element[static_cast<std::size_t>(e)];
  }
  int node(int corner, int e) const {
    return elements.node[static_cast<std::size_t>(corner)][static_cast<std::size_t>(e)];
  }
  std::uint64_t edge_key(const Corners& corners, const int (&edge)[2], int e) const {
    return key_of(node(corners[static_cast<std::size_t>(edge[0])], e),
                  node(corners[static_cast<std::size_t>(edge[1])], e));
  }

 private:
  std::vector<int> sorted_elements() {
    const int count = elements.count();
    Points centroids(3, count);
    for (int e = 0; e < count; ++e) {
      centroids.col(e).setZero();
      for (int a = 0; a < 4; ++a) centroids.col(e) += 0.25 * rest.nodes.col(rest.tets(a, e));
    }
    std::vector<int> out(static_cast<std::size_t>(count));
    std::iota(out.begin(), out.end(), 0);
    bisect(centroids, out, 0, count, chunks_of(count), starts);
    for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
      mesh::spatial_order(centroids, out, starts[c], starts[c + 1]);
      std::stable_sort(out.begin() + starts[c], out.begin() + starts[c + 1],
                       [&](int a, int b) { return material(a) < material(b); });
    }
    return out;
  }

  /// Returns the keys that `add` gives for the elements of each chunk.
  template <class Add>
  std::vector<std::vector<std::uint64_t>> keys(const Add& add) const {
    std::vector<std::vector<std::uint64_t>> out(starts.size() - 1);
    for (std::size_t c = 0; c < out.size(); ++c)
      for (int k = starts[c]; k < starts[c + 1]; ++k) {
        const int e = order[static_cast<std::size_t>(k)];
        add(sorted_corners(elements, static_cast<std::size_t>(e)), e, out[c]);
      }
    return out;
  }
};

ElementChunks::ElementChunks(const TetMesh& rest, const RestElements& elements,
                             const std::vector<int>& material_of_element)
    : nodal_volume(elements.nodal_volume), element_count_(elements.count()) {
  const Plan plan(rest, elements, material_of_element);
  groups.reserve(static_cast<std::size_t>((element_count_ + 7) / 8 + chunks_of(element_count_)));
  edges.reserve(groups.capacity());
  row_start.push_back(0);
  for (std::size_t c = 0; c + 1 < plan.starts.size(); ++c) add_chunk(plan, c);
  PALPATE_CHECK(most_nodes + 4 < 65536 && most_edges + 1 < 65536,
                "a chunk has {} nodes and {} edges, too many for 16-bit indices", most_nodes, most_edges);
  for (std::uint64_t key : plan.nodes.shared) shared_nodes.first.push_back(static_cast<int>(key));
  for (std::uint64_t key : plan.edges.shared) {
    shared_edges.first.push_back(static_cast<int>(key >> 32));
    shared_edges.second.push_back(static_cast<int>(key & 0xffffffffu));
  }
  shared_nodes.start = plan.nodes.start;
  shared_nodes.entries = plan.nodes.entries;
  shared_edges.start = plan.edges.start;
  shared_edges.entries = plan.edges.entries;
  const auto fit = [](auto&... grown) { (grown.shrink_to_fit(), ...); };
  fit(groups, edges, numbers_, runs, chunks, nodes, ends, row_start, row_owned, row_edges, shared_nodes.first,
      shared_edges.first, shared_edges.second);
  prefer_huge_pages(groups);
  prefer_huge_pages(edges);
  prefer_huge_pages(row_edges);
}

void ElementChunks::add_chunk(const Plan& plan, std::size_t c) {
  Chunk chunk;
  chunk.first_run = static_cast<int>(runs.size());
  chunk.first_node = static_cast<int>(nodes.size());
  chunk.nodes = static_cast<int>(plan.nodes.by_chunk[c].size());
  chunk.owned_nodes = plan.nodes.owned[c];
  chunk.first_shared_node = plan.nodes.first_shared[c];
  chunk.first_edge = static_cast<int>(ends.size() / 2);
  chunk.edges = static_cast<int>(plan.edges.by_chunk[c].size());
  chunk.owned_edges = plan.edges.owned[c];
  chunk.first_shared_edge = plan.edges.first_shared[c];
  for (std::uint64_t key : plan.nodes.by_chunk[c]) nodes.push_back(static_cast<int>(key));
  for (std::uint64_t key : plan.edges.by_chunk[c])
    for (std::uint64_t end : {key >> 32, key & 0xffffffffu})
      ends.push_back(static_cast<std::uint16_t>(plan.nodes.find(c, end)));
  make_rows(chunk);
  std::size_t lane = 0;
  for (int k = plan.starts[c]; k < plan.starts[c + 1]; ++k, lane = (lane + 1) % kLanes) {
    const int e = plan.order[static_cast<std::size_t>(k)];
    const bool first_of_run = k == plan.starts[c] || plan.material(e) != runs.back().material;
    if (first_of_run) {
      runs.push_back({static_cast<int>(groups.size()), 0, plan.material(e)});
      lane = 0;
    }
    if (lane == 0) add_group(chunk);
    fill_lane(plan, c, e, lane);
  }
  chunk.runs = static_cast<int>(runs.size()) - chunk.first_run;
  most_nodes = std::max(most_nodes, chunk.nodes);
  most_edges = std::max(most_edges, chunk.edges);
  chunks.push_back(chunk);
}

/// Adds a group to the last run.  Lanes without an element stay padding.
void ElementChunks::add_group(const Chunk& chunk) {
  ++runs.back().groups;
  groups.emplace_back();
  edges.emplace_back();
  numbers_.insert(numbers_.end(), kLanes, -1);
  for (std::size_t l = 0; l < kLanes; ++l) fill_up(groups.back(), edges.back(), l, chunk.nodes, chunk.edges);
}

/// Writes element e into a lane of the last group.
void ElementChunks::fill_lane(const Plan& plan, std::size_t chunk, int e, std::size_t lane) {
  ElementGroup& group = groups.back();
  const Corners corners = sorted_corners(plan.elements, static_cast<std::size_t>(e));
  for (std::size_t a = 0; a < 4; ++a)
    group.node[a][lane] = static_cast<std::uint16_t>(
        plan.nodes.find(chunk, static_cast<std::uint64_t>(plan.node(corners[a], e))));
  Mat3 Dm;
  for (int a = 1; a < 4; ++a)
    Dm.col(a - 1) = plan.rest.nodes.col(plan.node(corners[static_cast<std::size_t>(a)], e)) -
                    plan.rest.nodes.col(plan.node(corners[0], e));
  const Mat3 inverse = inverse_triangle(Dm);
  int entry = 0;
  for (int r = 0; r < 3; ++r)
    for (int axis = r; axis < 3; ++axis) group.inverse_edges[entry++][lane] = inverse(r, axis);
  for (std::size_t k = 0; k < 6; ++k)
    edges.back().edge[k][lane] =
        static_cast<std::uint16_t>(plan.edges.find(chunk, plan.edge_key(corners, kEdgeCorners[k], e)));
  group.volume[lane] = plan.elements.volume[static_cast<std::size_t>(e)];
  numbers_[numbers_.size() - kLanes + lane] = e;
}

/// Builds the rows of a chunk: the edges at each node, owned ones first, sorted by the node at the other end,
/// which is the order of the matrix's columns; then the shared ones.
void ElementChunks::make_rows(const Chunk& chunk) {
  struct Entry {
    bool shared;
    int other;
    std::uint32_t edge;
  };
  std::vector<std::vector<Entry>> rows(static_cast<std::size_t>(chunk.nodes));
  for (int k = 0; k < chunk.edges; ++k) {
    const auto at = 2 * static_cast<std::size_t>(chunk.first_edge + k);
    const auto global = [&](std::uint16_t end) {
      return nodes[static_cast<std::size_t>(chunk.first_node + end)];
    };
    const auto edge = 2 * static_cast<std::uint32_t>(k);
    rows[ends[at]].push_back({k >= chunk.owned_edges, global(ends[at + 1]), edge});
    rows[ends[at + 1]].push_back({k >= chunk.owned_edges, global(ends[at]), edge + 1});
  }
  for (auto& row : rows) {
    std::sort(row.begin(), row.end(), [](const Entry& a, const Entry& b) {
      return a.shared != b.shared ? b.shared : a.other < b.other;
    });
    row_owned.push_back(static_cast<std::int32_t>(
        std::count_if(row.begin(), row.end(), [](const Entry& e) { return !e.shared; })));
    for (const Entry& e : row) row_edges.push_back(e.edge);
    row_start.push_back(static_cast<std::int32_t>(row_edges.size()));
  }
}

Mat3 ElementChunks::Element::edges(const double* field) const {
  const Eigen::Map<const Vec3> origin(field + 3 * node[0]);
  Mat3 m;
  for (int a = 1; a < 4; ++a) m.col(a - 1) = Eigen::Map<const Vec3>(field + 3 * node[a]) - origin;
  return m;
}

ElementChunks::Element ElementChunks::element(const Chunk& chunk, const Run& run, int group_number,
                                              int lane) const {
  const ElementGroup& group = groups[static_cast<std::size_t>(group_number)];
  Element out;
  out.material = run.material;
  out.number = numbers_[static_cast<std::size_t>(ElementGroup::kLanes * group_number + lane)];
  for (int a = 0; a < 4; ++a)
    out.node[a] = nodes[static_cast<std::size_t>(chunk.first_node + group.node[a][lane])];
  out.gradients.setZero();
  int entry = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = r; c < 3; ++c) out.gradients(r, c) = group.inverse_edges[entry++][lane];
  out.volume = group.volume[lane];
  return out;
}

std::size_t ElementChunks::bytes() const {
  const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  const auto sums = [&](const SharedSums& s) {
    return of(s.first) + of(s.second) + of(s.start) + of(s.entries);
  };
  return of(groups) + of(edges) + of(numbers_) + of(runs) + of(chunks) + of(nodes) + of(ends) +
         of(row_start) + of(row_owned) + of(row_edges) + of(nodal_volume) + sums(shared_nodes) +
         sums(shared_edges);
}

}  // namespace palpate::fem
