#include "render/marks.h"

#include <gtest/gtest.h>

#include <set>

#include "render/shapes.h"

using namespace palpate;

namespace {

double volume(const render::Surface& s) {
  double sum = 0.0;
  for (const auto f : s.faces.colwise())
    sum += s.points.col(f[0]).dot(s.points.col(f[1]).cross(s.points.col(f[2]))) / 6.0;
  return sum;
}

}  // namespace

TEST(Outline, ACubeHasTwelveEdgesAndNoDiagonals) {
  const render::Surface cube = cube_surface();
  const double width = 0.02;
  const render::Surface edges = render::outline(cube.points, cube.faces, width);
  EXPECT_EQ(edges.points.cols(), 12 * 8);
  EXPECT_EQ(edges.faces.cols(), 12 * 8);
  for (const auto p : edges.points.colwise()) {
    // near an edge: two coordinates near 0 or 1
    int near = 0;
    for (const double x : p) near += std::min(std::abs(x), std::abs(x - 1.0)) <= width / 2 + 1e-12;
    EXPECT_GE(near, 2);
  }
}

TEST(Outline, BordersAreEdges) {
  render::Surface cube = cube_surface();
  const Faces two = cube.faces.leftCols(2);
  EXPECT_EQ(render::outline(cube.points, two, 0.02).points.cols(), 4 * 8);  // one square face: its rim
}

TEST(Dots, AreOutwardOctahedraAboutThePoints) {
  Points points(3, 2);
  points << 1, -4, 2, 5, 3, 0.5;
  const double size = 0.1;
  const render::Surface dots = render::dots(points, size);
  ASSERT_EQ(dots.faces.cols(), 16);
  EXPECT_NEAR(volume(dots), 2.0 * size * size * size / 6.0, 1e-12);  // outward orientation: positive
  for (Eigen::Index i = 0; i < dots.points.cols(); ++i)
    EXPECT_NEAR((dots.points.col(i) - points.col(i / 6)).norm(), size / 2, 1e-12);
}
