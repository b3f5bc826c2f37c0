// Radius of mean curvature of closed surfaces whose integral of H is known.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mesh/curvature.h"
#include "palpate/mesh/generators.h"

using namespace palpate;

TEST(MeanRadius, IsTheRadiusOfABall) { EXPECT_NEAR(mesh::mean_radius(mesh::sphere(0.03, 24)), 0.03, 3e-4); }

// The integral is half of the edges' lengths times pi/2, however the faces are divided into triangles.
TEST(MeanRadius, OfABoxSitsInItsEdges) {
  const Vec3 size(0.14, 0.05, 0.01);
  const double area = 2.0 * (0.14 * 0.05 + 0.05 * 0.01 + 0.01 * 0.14);
  for (const int n : {1, 7})
    EXPECT_NEAR(mesh::mean_radius(mesh::box_surface(size, {n, n, n})), area / (std::numbers::pi * 0.2),
                1e-12);
}

// A ball with a spherical cavity: the cavity's integral is negative, which leaves 4 pi (R - r).
TEST(MeanRadius, HollowPartsCountAgainstRoundOnes) {
  TriMesh shell = mesh::sphere(0.03, 24);
  const TriMesh hole = mesh::sphere(0.02, 24);
  const Eigen::Index v = shell.vertices.cols(), f = shell.faces.cols();
  shell.vertices.conservativeResize(3, v + hole.vertices.cols());
  shell.vertices.rightCols(hole.vertices.cols()) = hole.vertices;
  shell.faces.conservativeResize(3, f + hole.faces.cols());
  for (Eigen::Index i = 0; i < hole.faces.cols(); ++i)
    for (int k = 0; k < 3; ++k) shell.faces(k, f + i) = static_cast<int>(v) + hole.faces(2 - k, i);
  EXPECT_NEAR(mesh::mean_radius(shell), (0.03 * 0.03 + 0.02 * 0.02) / 0.01, 1e-3);
  TriMesh inside_out = hole;
  inside_out.faces.row(0).swap(inside_out.faces.row(1));
  EXPECT_TRUE(std::isinf(mesh::mean_radius(inside_out)));
}
