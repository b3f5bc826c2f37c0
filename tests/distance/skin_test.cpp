// Topology of a skin: only closed surfaces are accepted, clusters hold every face once, neighbours are
// mutual.
#include <set>

#include "bodies.h"

using namespace distance_tests;

TEST(DistanceSkin, ClustersHoldEachFaceOnceAndTreeEndsInThem) {
  for (const int n : {1, 3, 11}) {
    const TriMesh mesh = bumpy_sphere(1.0, n, 0.1);
    const Skin skin = make_skin(mesh);
    ASSERT_EQ(skin.face_count(), 20 * n * n);
    EXPECT_EQ(std::set<int>(skin.given_face.begin(), skin.given_face.end()).size(), skin.given_face.size());
    std::vector<int> held(static_cast<std::size_t>(skin.cluster_count()));
    for (const ClusterNode& node : skin.tree) {
      if (node.right) continue;
      ASSERT_EQ(node.end, node.begin + 1);
      ++held[static_cast<std::size_t>(node.begin)];
    }
    EXPECT_EQ(held, std::vector<int>(held.size(), 1));
    for (int f = 0; f < skin.face_count(); ++f)
      EXPECT_EQ(skin.faces.col(f), mesh.faces.col(skin.given_face[static_cast<std::size_t>(f)]));
  }
}

TEST(DistanceSkin, NeighboursShareTheEdgeAndFansTheVertex) {
  const Skin skin = make_skin(bumpy_sphere(1.0, 5, 0.1));
  for (int f = 0; f < skin.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const auto across = skin.faces.col(skin.across(k, f));
      EXPECT_TRUE((across.array() == skin.faces((k + 1) % 3, f)).any());
      EXPECT_TRUE((across.array() == skin.faces((k + 2) % 3, f)).any());
      EXPECT_NE(skin.across(k, f), f);
    }
  ASSERT_EQ(skin.fan_begin.back(), 3 * skin.face_count());
  for (int v = 0; v < skin.vertex_count(); ++v)
    for (int i = skin.fan_begin[v]; i < skin.fan_begin[v + 1]; ++i)
      EXPECT_TRUE((skin.faces.col(skin.fan[i]).array() == v).any());
}

TEST(DistanceSkin, RejectsWhatHasNoInside) {
  TriMesh open = mesh::sphere(1.0, 2);
  open.faces.conservativeResize(3, open.faces.cols() - 1);
  expect_message([&] { make_skin(open); }, {"closed skin", "one side only"});
  TriMesh flipped = mesh::sphere(1.0, 2);
  std::swap(flipped.faces(0, 3), flipped.faces(1, 3));
  expect_message([&] { make_skin(flipped); }, {"closed skin", "twice in the same direction"});
  TriMesh flat = mesh::sphere(1.0, 2);
  flat.vertices.col(flat.faces(0, 5)) = flat.vertices.col(flat.faces(1, 5));
  expect_message([&] { make_skin(flat); }, {"has no area"});
  TriMesh broken = mesh::sphere(1.0, 2);
  broken.vertices(1, 4) = std::nan("");
  expect_message([&] { make_skin(broken); }, {"finite"});
}
