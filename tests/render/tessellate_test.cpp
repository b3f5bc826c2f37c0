#include "render/tessellate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "render/corners.h"
#include "render/scene.h"

using namespace palpate;
using render::Corner;

namespace {

/// A view in which 1 m is `scale` half images of 400 pixels, without perspective.
render::Viewport viewport(float scale) {
  Eigen::Matrix4f projection = Eigen::Matrix4f::Identity();
  projection.topLeftCorner<3, 3>() *= scale;
  return {projection, 400, 400};
}

std::vector<Corner> tessellated(const render::Surface& surface, float scale) {
  return render::tessellated(render::corners(surface, {"x", "m", 0.0, 1.0}, Vec3::Zero()), surface.faces,
                             viewport(scale));
}

/// The boundary of a soft ball with some 24 edges around: its triangles turn by less than a crease.
render::Surface coarse_ball(double radius) {
  const mesh::Boundary outer = mesh::boundary(mesh::ball(radius, radius / 4.0));
  render::Surface ball;
  ball.points = outer.surface.vertices;
  ball.faces = outer.surface.faces;
  return ball;
}

/// Returns the largest distance of the middles of all triangles from the sphere.
double error_of(const std::vector<Corner>& corners, double radius) {
  double worst = 0.0;
  for (std::size_t f = 0; f + 2 < corners.size(); f += 3) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) middle[i] += corners[f + k].position[i] / 3.0;
    worst = std::max(worst, std::abs(middle.norm() - radius));
  }
  return worst;
}

}  // namespace

TEST(Tessellated, ACoarseBallBecomesASphere) {
  const double radius = 0.04;
  const render::Surface ball = coarse_ball(radius);
  const std::vector<Corner> coarse = tessellated(ball, 1e-3f), fine = tessellated(ball, 20.0f);
  EXPECT_EQ(coarse.size(), static_cast<std::size_t>(ball.faces.size())) << "too small to be seen";
  ASSERT_GT(fine.size(), 8 * coarse.size());
  // 160 pixels are the radius: the error is below a pixel, and was many.
  EXPECT_GT(error_of(coarse, radius), 0.01 * radius);
  EXPECT_LT(error_of(fine, radius), 0.004 * radius);
}

TEST(Tessellated, NeighboursShareTheirEdges) {
  const render::Surface ball = coarse_ball(0.04);
  const std::vector<Corner> fine = tessellated(ball, 20.0f);
  // Every edge of a closed surface without gaps belongs to two triangles, at the same positions.
  std::vector<Eigen::Vector3f> points;
  const auto index = [&](const Corner& c) {  // of a point there, up to rounding
    const Eigen::Vector3f p(c.position[0], c.position[1], c.position[2]);
    const auto near = [&](const Eigen::Vector3f& q) { return (p - q).squaredNorm() < 1e-14f; };
    const auto found = std::find_if(points.begin(), points.end(), near);
    if (found == points.end()) return points.push_back(p), points.size() - 1;
    return static_cast<std::size_t>(found - points.begin());
  };
  std::map<std::pair<std::size_t, std::size_t>, int> edges;
  for (std::size_t f = 0; f + 2 < fine.size(); f += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = index(fine[f + k]), b = index(fine[f + (k + 1) % 3]);
      ++edges[{std::min(a, b), std::max(a, b)}];
    }
  ASSERT_GT(edges.size(), 1000u);
  const auto open = std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second != 2; });
  EXPECT_EQ(open, 0);
}

TEST(Tessellated, ABlockKeepsItsEdgesAndFaces) {
  render::Surface block;
  const TriMesh box = mesh::box_surface(Vec3(0.02, 0.02, 0.02), {2, 2, 2});
  block.points = box.vertices;
  block.faces = box.faces;
  const std::vector<Corner> corners = tessellated(block, 40.0f);
  EXPECT_EQ(corners.size(), static_cast<std::size_t>(box.faces.size())) << "flat: nothing to be gained";
}

TEST(Tessellated, ACreaseStaysStraight) {
  // Half a cylinder of 6 flat strips, closed by a plane: its round side is smoothed, its sharp edges are not.
  render::Surface half;
  constexpr int kStrips = 6;
  half.points.resize(3, 2 * (kStrips + 1));
  for (int i = 0; i <= kStrips; ++i)
    for (int end = 0; end < 2; ++end) {
      const double angle = std::numbers::pi * i / kStrips;
      half.points.col(2 * i + end) = Vec3(std::cos(angle), end - 0.5, std::sin(angle));
    }
  half.faces.resize(3, 2 * kStrips + 2);
  for (int i = 0; i < kStrips; ++i) {
    half.faces.col(2 * i) = Eigen::Vector3i(2 * i, 2 * i + 2, 2 * i + 1);
    half.faces.col(2 * i + 1) = Eigen::Vector3i(2 * i + 1, 2 * i + 2, 2 * i + 3);
  }
  half.faces.col(2 * kStrips) = Eigen::Vector3i(0, 1, 2 * kStrips);
  half.faces.col(2 * kStrips + 1) = Eigen::Vector3i(1, 2 * kStrips + 1, 2 * kStrips);
  const std::vector<Corner> corners = tessellated(half, 0.9f);
  ASSERT_GT(corners.size(), static_cast<std::size_t>(half.faces.size()));
  int on_round = 0, on_plane = 0;
  for (const Corner& c : corners) {
    const double reach = std::hypot(c.position[0], c.position[2]);
    if (std::abs(c.position[2]) < 1e-6) {
      ++on_plane;
      EXPECT_LE(std::abs(c.position[0]), 1.0 + 1e-6);
    } else if (c.position[2] > 0.52) {  // the strips at the sharp edges are flat there
      ++on_round;
      EXPECT_NEAR(reach, 1.0, 0.015) << "chords lie up to 0.034 inside";
    }
    EXPECT_LE(std::abs(c.position[1]), 0.5 + 1e-6);
  }
  EXPECT_GT(on_round, 100);
  EXPECT_GT(on_plane, 6);
}
