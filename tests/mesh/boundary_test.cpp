#include "palpate/mesh/boundary.h"

#include <gtest/gtest.h>

#include <numbers>

#include "palpate/mesh/generators.h"
#include "palpate/mesh/quality.h"

using namespace palpate;
using namespace palpate::mesh;

TEST(Boundary, OfOneTetrahedronIsItsFourFacesOutwards) {
  const Boundary b = boundary(corner_tet({1, 2, 3}));
  EXPECT_EQ(b.node_of_vertex, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(b.tet_of_face, (std::vector<int>{0, 0, 0, 0}));
  EXPECT_DOUBLE_EQ(enclosed_volume(b.surface), 1.0);
}

TEST(Boundary, LeavesOutInteriorNodesAndNamesEachFacesTetrahedron) {
  const TetMesh mesh = box({1, 1, 1}, {4, 4, 4});
  const Boundary b = boundary(mesh);
  EXPECT_EQ(b.node_of_vertex.size(), 125u - 27u);
  EXPECT_EQ(b.surface.faces.cols(), 6 * 16 * 2);
  ASSERT_EQ(b.tet_of_face.size(), static_cast<std::size_t>(b.surface.faces.cols()));
  for (std::size_t f = 0; f < b.tet_of_face.size(); ++f) {
    int shared = 0;
    Vec3 centre = Vec3::Zero(), normal_at = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const int node =
          b.node_of_vertex[static_cast<std::size_t>(b.surface.faces(k, static_cast<Eigen::Index>(f)))];
      normal_at += mesh.nodes.col(node) / 3;
      for (int j = 0; j < 4; ++j) shared += mesh.tets(j, b.tet_of_face[f]) == node;
    }
    for (int j = 0; j < 4; ++j) centre += mesh.nodes.col(mesh.tets(j, b.tet_of_face[f])) / 4;
    EXPECT_EQ(shared, 3);
    const auto v = [&](int k) -> Vec3 {
      return b.surface.vertices.col(b.surface.faces(k, static_cast<Eigen::Index>(f)));
    };
    EXPECT_GT((v(1) - v(0)).cross(v(2) - v(0)).dot(normal_at - centre), 0)
        << "face " << f << " looks inwards";
  }
}

TEST(Boundary, EnclosedVolumeDoesNotDependOnPlaceAndTurnsWithTheFaces) {
  TriMesh s = sphere(1.0, 6);
  const double volume = enclosed_volume(s);
  s.vertices.colwise() += Vec3(1e3, -2e3, 5e2);
  EXPECT_NEAR(enclosed_volume(s), volume, 1e-11);
  s.faces.row(1).swap(s.faces.row(2));
  EXPECT_NEAR(enclosed_volume(s), -volume, 1e-11);
  EXPECT_EQ(enclosed_volume(TriMesh{}), 0.0);
}

TEST(Quality, DihedralAnglesOfKnownTetrahedra) {
  const double degree = std::numbers::pi / 180;
  TetMesh regular = corner_tet({1, 1, 1});
  regular.nodes << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1;
  if (tet_volume(regular, 0) < 0) std::swap(regular.tets(2, 0), regular.tets(3, 0));
  for (const double angle : dihedral_angles(regular, 0)) EXPECT_NEAR(angle, std::acos(1.0 / 3.0), 1e-15);

  // Along the legs of the unit corner the faces are perpendicular; along the other edges the angle is
  // acos(1/sqrt 3).
  const auto corner = dihedral_angles(corner_tet({1, 1, 1}), 0);
  for (std::size_t e = 0; e < 6; ++e)
    EXPECT_NEAR(corner[e], kTetEdges[e][0] == 0 ? 90 * degree : std::acos(1 / std::sqrt(3.0)), 1e-15) << e;

  // A sliver with its four nodes almost in a plane: small angles keep their relative accuracy.
  TetMesh sliver = corner_tet({1, 1, 1});
  const double lift = 1e-6;
  sliver.nodes << 1, -1, 0, 0, 0, 0, 1, -1, lift, lift, -lift, -lift;
  if (tet_volume(sliver, 0) < 0) std::swap(sliver.tets(2, 0), sliver.tets(3, 0));
  EXPECT_NEAR(measure(sliver).smallest_dihedral_deg * degree / (4 * lift / std::sqrt(2.0)), 1.0, 1e-6);
}

TEST(Quality, MeasureCountsAndMeasures) {
  const MeshReport r = measure(box({2, 2, 2}, {2, 2, 2}));
  EXPECT_EQ(r.nodes, 27);
  EXPECT_EQ(r.elements, 40);
  EXPECT_NEAR(r.volume, 8.0, 1e-14);
  EXPECT_NEAR(r.smallest_edge, 1.0, 1e-15);
  EXPECT_NEAR(r.largest_edge, std::sqrt(2.0), 1e-15);
}
