// Uniform refinement of tetrahedra and of surfaces.
#include "mesh/refine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "mesh/surface_checks.h"
#include "mesh/tet_checks.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"

using namespace palpate;

namespace {

double volume(const TetMesh& mesh, Eigen::Index tet) { return mesh::tet_volume(mesh, static_cast<int>(tet)); }

/// Checks a mesh, as a scene does.
mesh::MeshReport checked(TetMesh& mesh) {
  mesh::Provenance from;
  from.source = "refined";
  return mesh::check_tets(mesh, from);
}

double area(const TriMesh& mesh) {
  double sum = 0.0;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const auto x = [&](int k) { return Vec3(mesh.vertices.col(mesh.faces(k, f))); };
    sum += 0.5 * (x(1) - x(0)).cross(x(2) - x(0)).norm();
  }
  return sum;
}

TEST(Refine, EightChildrenOfEqualVolumeFillEachTetrahedron) {
  const TetMesh coarse = mesh::perturbed(mesh::ball(0.03, 0.012), 0.15, 7);
  const mesh::RefinedTets fine = mesh::refine(coarse);
  ASSERT_EQ(fine.mesh.tets.cols(), 8 * coarse.tets.cols());
  for (Eigen::Index t = 0; t < coarse.tets.cols(); ++t)
    for (Eigen::Index child = 8 * t; child < 8 * t + 8; ++child)
      EXPECT_NEAR(volume(fine.mesh, child) / volume(coarse, t), 0.125, 1e-12);
}

TEST(Refine, NodesAreKeptAndFollowedByTheMidpointsOfEdges) {
  const TetMesh coarse = mesh::box({0.02, 0.03, 0.04}, {2, 2, 3});
  const mesh::RefinedTets fine = mesh::refine(coarse);
  EXPECT_EQ(fine.mesh.nodes.leftCols(coarse.nodes.cols()), coarse.nodes);
  ASSERT_EQ(fine.mesh.nodes.cols(), coarse.nodes.cols() + static_cast<Eigen::Index>(fine.edges.size()));
  for (std::size_t i = 0; i < fine.edges.size(); ++i) {
    const Vec3 middle = 0.5 * (coarse.nodes.col(fine.edges[i][0]) + coarse.nodes.col(fine.edges[i][1]));
    EXPECT_EQ(fine.mesh.nodes.col(coarse.nodes.cols() + static_cast<Eigen::Index>(i)), middle);
  }
  // Euler: V - E + F - T = 1 for a ball-shaped complex; each edge becomes a node.
  std::set<std::array<int, 3>> faces;
  for (Eigen::Index t = 0; t < coarse.tets.cols(); ++t)
    for (int k = 0; k < 4; ++k) {
      std::array<int, 3> face{coarse.tets((k + 1) % 4, t), coarse.tets((k + 2) % 4, t),
                              coarse.tets((k + 3) % 4, t)};
      std::sort(face.begin(), face.end());
      faces.insert(face);
    }
  EXPECT_EQ(coarse.nodes.cols() - static_cast<long>(fine.edges.size()) + static_cast<long>(faces.size()) -
                coarse.tets.cols(),
            1);
}

TEST(Refine, TheRefinedMeshIsConformingAndItsBoundaryIsTheRefinedBoundary) {
  const TetMesh coarse = mesh::ball(0.03, 0.012);
  mesh::RefinedTets fine = mesh::refine(coarse);
  // check_tets() rejects three elements on one face, and unreferenced nodes.
  EXPECT_EQ(checked(fine.mesh).flipped, 0);
  const TriMesh before = mesh::boundary(coarse).surface, after = mesh::boundary(fine.mesh).surface;
  EXPECT_EQ(after.faces.cols(), 4 * before.faces.cols());
  EXPECT_NEAR(area(after) / area(before), 1.0, 1e-12);
}

TEST(Refine, ShapesStayGoodOverThreeDivisions) {
  TetMesh mesh = mesh::ball(0.03, 0.015);
  const double before = checked(mesh).smallest_dihedral_deg;
  for (int i = 0; i < 3; ++i) mesh = mesh::refine(mesh).mesh;
  const double after = checked(mesh).smallest_dihedral_deg;
  EXPECT_GT(after, 0.6 * before);
}

TEST(Refine, ASurfaceKeepsItsShapeAndStaysClosedAndOrientedOutwards) {
  const TriMesh coarse = mesh::sphere(0.02, 3);
  TriMesh fine = mesh::refine(coarse);
  EXPECT_EQ(fine.faces.cols(), 4 * coarse.faces.cols());
  EXPECT_NEAR(area(fine) / area(coarse), 1.0, 1e-12);
  EXPECT_EQ(fine.vertices.leftCols(coarse.vertices.cols()), coarse.vertices);
  EXPECT_EQ(mesh::check_surface(fine, mesh::surface_provenance("refined")).flipped, 0);
}

}  // namespace
