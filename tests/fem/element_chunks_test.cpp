#include "../../src/fem/element_chunks.h"

#include <map>
#include <set>

#include "fem_fixture.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

namespace {

constexpr int kCells = 12;  // 10,368 tetrahedra: enough chunks for some edges to lie in four

TetMesh mesh() { return jittered_cube(kCells, 0.2, 11); }
ElementChunks chunks_of(const TetMesh& mesh) { return {mesh, make_rest_elements(mesh, "a test")}; }

Mat3 rest_edges(const TetMesh& mesh, const ElementChunks::Element& e) {
  Mat3 Dm;
  for (int a = 1; a < 4; ++a) Dm.col(a - 1) = mesh.nodes.col(e.node[a]) - mesh.nodes.col(e.node[0]);
  return Dm;
}

using Key = std::pair<int, int>;

/// Owner chunk of each node or edge, and the chunks that share it, in order; `keys(chunk)` lists a chunk's
/// owned keys, then its shared ones.
struct Holders {
  std::map<Key, int> owned;
  std::map<Key, std::vector<std::pair<int, int>>> shared;  ///< chunk, index of the contribution
};

template <class Keys>
Holders holders(const ElementChunks& chunks, int ElementChunks::Chunk::*owned,
                int ElementChunks::Chunk::*first_shared, Keys&& keys) {
  Holders out;
  for (std::size_t c = 0; c < chunks.chunks.size(); ++c) {
    const ElementChunks::Chunk& chunk = chunks.chunks[c];
    const std::vector<Key> all = keys(chunk);
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (static_cast<int>(k) < chunk.*owned)
        EXPECT_TRUE(out.owned.emplace(all[k], static_cast<int>(c)).second) << "owned by two chunks";
      else
        out.shared[all[k]].emplace_back(static_cast<int>(c),
                                        chunk.*first_shared + static_cast<int>(k) - chunk.*owned);
    }
  }
  return out;
}

/// Checks that each key is owned by the first chunk that has it, and that the sums gather the contribution of
/// each later chunk once, in the order of the chunks.
void expect_sums(const Holders& found, const SharedSums& sums, bool edges) {
  ASSERT_EQ(static_cast<std::size_t>(sums.count()), found.shared.size());
  std::set<int> places;
  std::size_t most = 0;
  for (std::size_t k = 0; k < found.shared.size(); ++k) {
    const Key key{sums.first[k], edges ? sums.second[k] : 0};
    ASSERT_TRUE(found.shared.count(key) == 1 && found.owned.count(key) == 1);
    const auto& shared = found.shared.at(key);
    ASSERT_EQ(static_cast<std::size_t>(sums.start[k + 1] - sums.start[k]), shared.size());
    for (std::size_t p = 0; p < shared.size(); ++p) {
      EXPECT_EQ(sums.entries[static_cast<std::size_t>(sums.start[k]) + p], shared[p].second);
      EXPECT_GT(shared[p].first, p == 0 ? found.owned.at(key) : shared[p - 1].first);
      EXPECT_TRUE(places.insert(shared[p].second).second);
    }
    most = std::max(most, shared.size());
  }
  EXPECT_EQ(static_cast<int>(places.size()), sums.contributions());
  EXPECT_GE(most, 2u) << "the mesh has nothing that three chunks share";
}

TEST(ElementChunks, HaveEachElementOnce) {
  const TetMesh rest = mesh();
  std::vector<int> times(static_cast<std::size_t>(rest.tets.cols()), 0);
  chunks_of(rest).for_each([&](const ElementChunks::Element& e) {
    ++times[static_cast<std::size_t>(e.number)];
    std::set<int> nodes(e.node, e.node + 4), expected;
    for (int a = 0; a < 4; ++a) expected.insert(rest.tets(a, e.number));
    EXPECT_EQ(nodes, expected);
  });
  EXPECT_EQ(times, std::vector<int>(times.size(), 1));
}

/// T^-1 is triangular, and Dm T^-1 = Q is a rotation without reflection, which is sufficient for an isotropic
/// material.
TEST(ElementChunks, HaveRestShapesTurnedIntoTriangles) {
  const TetMesh rest = mesh();
  int odd = 0;
  chunks_of(rest).for_each([&](const ElementChunks::Element& e) {
    const Mat3 Dm = rest_edges(rest, e), Q = Dm * e.gradients;
    EXPECT_LT((Q.transpose() * Q - Mat3::Identity()).norm(), 1e-13);
    EXPECT_GT(Q.determinant(), 0.0);
    EXPECT_EQ(e.gradients(1, 0), 0.0);
    EXPECT_EQ(e.gradients(2, 0), 0.0);
    EXPECT_EQ(e.gradients(2, 1), 0.0);
    EXPECT_NEAR(std::abs(Dm.determinant()) / 6.0, e.volume, 1e-13 * e.volume);
    odd += Dm.determinant() < 0.0;
  });
  EXPECT_GT(odd, 1000) << "nodes in ascending order are mirror images as often as not";
}

/// A sliver's rest edges keep their lengths and angles to rounding.
TEST(ElementChunks, TurnSliversAsWell) {
  TetMesh rest = one_tet();
  rest.nodes.row(2) *= 1e-7;
  chunks_of(rest).for_each([&](const ElementChunks::Element& e) {
    const Mat3 Dm = rest_edges(rest, e), T = e.gradients.inverse();
    EXPECT_LT((T.transpose() * T - Dm.transpose() * Dm).norm(), 1e-14 * Dm.squaredNorm());
  });
}

TEST(ElementChunks, ShareNodesAndEdgesThatTheFirstOneOwns) {
  const TetMesh rest = mesh();
  const ElementChunks chunks = chunks_of(rest);
  ASSERT_GE(chunks.chunks.size(), 8u);
  const auto node = [&](const ElementChunks::Chunk& chunk, int k) {
    return chunks.nodes[static_cast<std::size_t>(chunk.first_node + k)];
  };
  const Holders nodes =
      holders(chunks, &ElementChunks::Chunk::owned_nodes, &ElementChunks::Chunk::first_shared_node,
              [&](const ElementChunks::Chunk& chunk) {
                std::vector<Key> keys;
                for (int k = 0; k < chunk.nodes; ++k) keys.emplace_back(node(chunk, k), 0);
                return keys;
              });
  EXPECT_EQ(static_cast<Eigen::Index>(nodes.owned.size()), rest.nodes.cols());
  expect_sums(nodes, chunks.shared_nodes, false);
  const Holders edges = holders(
      chunks, &ElementChunks::Chunk::owned_edges, &ElementChunks::Chunk::first_shared_edge,
      [&](const ElementChunks::Chunk& chunk) {
        std::vector<Key> keys;
        for (int k = 0; k < chunk.edges; ++k) {
          const std::uint16_t* ends = chunks.ends.data() + 2 * static_cast<std::size_t>(chunk.first_edge + k);
          keys.emplace_back(node(chunk, ends[0]), node(chunk, ends[1]));
        }
        return keys;
      });
  std::set<Key> expected;
  for (Eigen::Index e = 0; e < rest.tets.cols(); ++e)
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b)
        if (rest.tets(a, e) < rest.tets(b, e)) expected.emplace(rest.tets(a, e), rest.tets(b, e));
  EXPECT_EQ(edges.owned.size(), expected.size());
  for (const Key& key : expected) EXPECT_EQ(edges.owned.count(key), 1u);
  expect_sums(edges, chunks.shared_edges, true);
}

}  // namespace
