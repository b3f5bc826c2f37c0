#include "mesh/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <random>

#include "helpers.h"

using namespace palpate;
using namespace palpate::mesh;

namespace {

using Corners = std::vector<Vec3>;

Vec3 twice_area(const Corners& p, const std::array<int, 3>& t) {
  const auto at = [&](std::size_t k) -> const Vec3& { return p[static_cast<std::size_t>(t[k])]; };
  return (at(1) - at(0)).cross(at(2) - at(0));
}

/// Checks that the triangles cover the polygon once: each has its orientation, and their areas sum to `area`.
void expect_cover(const Corners& corners, double area, const Vec3& normal) {
  const PolygonCut cut = cut_polygon(corners);
  EXPECT_TRUE(cut.simple);
  EXPECT_EQ(cut.triangles.size(), corners.size() - 2);
  double sum = 0;
  for (const auto& triangle : cut.triangles) {
    const Vec3 twice = twice_area(corners, triangle);
    EXPECT_GT(twice.dot(normal), 0.0);
    sum += twice.norm() / 2;
  }
  EXPECT_NEAR(sum, area, 1e-12 * std::max(area, 1.0));
  // each edge of the outline belongs to one triangle, and each inner edge to two, in both directions
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : cut.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  const int n = static_cast<int>(corners.size());
  for (const auto& [edge, times] : edges) {
    EXPECT_EQ(times, 1);
    EXPECT_EQ(edges.contains({edge.second, edge.first}), edge.second != (edge.first + 1) % n);
  }
  for (int i = 0; i < n; ++i) EXPECT_TRUE(edges.contains({i, (i + 1) % n}));
}

Corners flat(const std::vector<std::array<double, 2>>& points) {
  Corners out;
  for (const auto& [x, y] : points) out.emplace_back(x, y, 0.0);
  return out;
}

/// A U-shape, concave at corners 4 and 5.
Corners notched() { return flat({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}); }

}  // namespace

TEST(Polygon, AConvexOneIsAFanAboutItsFirstCorner) {
  const PolygonCut cut = cut_polygon(flat({{0, 0}, {2, 0}, {3, 1}, {1, 2}, {0, 1}}));
  EXPECT_EQ(cut.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  EXPECT_EQ(cut.warp, 0.0);
}

TEST(Polygon, AConcaveOneIsCoveredOnceFromEveryFirstCorner) {
  Corners corners = notched();
  for (std::size_t first = 0; first < corners.size(); ++first) {
    expect_cover(corners, 7.0, Vec3::UnitZ());
    std::rotate(corners.begin(), corners.begin() + 1, corners.end());
  }
  std::reverse(corners.begin(), corners.end());
  expect_cover(corners, 7.0, -Vec3::UnitZ());
}

TEST(Polygon, CornersOnALineAreKept) {
  expect_cover(flat({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 2}, {0, 2}}), 6.0, Vec3::UnitZ());
  expect_cover(flat({{0, 0}, {0.1, 0}, {0.2, 0}, {0.3, 0}, {0.3, 0.1}, {0.3, 0.2}}), 0.03, Vec3::UnitZ());
}

// r(a) about an inner point gives a simple outline; its area follows from the shoelace formula.
TEST(Polygon, RandomOutlinesInRandomPlanesAreCoveredOnce) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0.05, 1.0), angle(0.0, 2 * std::numbers::pi);
  int concave = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 4 + trial % 37;
    const Eigen::Matrix3d turn =
        (Eigen::AngleAxisd(angle(random), Vec3::UnitX()) * Eigen::AngleAxisd(angle(random), Vec3::UnitZ()))
            .toRotationMatrix();
    Corners corners;
    double area = 0;
    std::vector<double> radius;
    for (int i = 0; i < n; ++i) radius.push_back(share(random));
    for (int i = 0; i < n; ++i) {
      const double a = 2 * std::numbers::pi * i / n;
      corners.push_back(turn * Vec3(radius[static_cast<std::size_t>(i)] * std::cos(a),
                                    radius[static_cast<std::size_t>(i)] * std::sin(a), 0.3));
      area += radius[static_cast<std::size_t>(i)] * radius[static_cast<std::size_t>((i + 1) % n)] *
              std::sin(2 * std::numbers::pi / n) / 2;
    }
    expect_cover(corners, area, turn.col(2));
    concave += cut_polygon(corners).triangles[0] != std::array{0, 1, 2};
    EXPECT_LT(cut_polygon(corners).warp, 1e-12);
  }
  EXPECT_GT(concave, 100);
}

TEST(Polygon, AHoleBehindABridgeStaysOpen) {
  // a square of 4 with a square hole of 1, connected by an edge between corners 0 and 4
  const Corners corners =
      flat({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}});
  const PolygonCut cut = cut_polygon(corners);
  EXPECT_TRUE(cut.simple);
  double sum = 0;
  for (const auto& t : cut.triangles) sum += twice_area(corners, t).z() / 2;
  EXPECT_NEAR(sum, 15.0, 1e-12);
}

TEST(Polygon, AnOutlineThatCrossesOrTouchesItselfIsToldApart) {
  EXPECT_FALSE(cut_polygon(flat({{0, 0}, {2, 0}, {0, 1}, {2, 1.5}})).simple);
  EXPECT_FALSE(cut_polygon(flat({{0, 0}, {4, 0}, {4, 2}, {2, 0}, {0, 2}})).simple) << "a corner on an edge";
  Corners star;
  for (int i = 0; i < 5; ++i)
    star.emplace_back(std::cos(0.8 * std::numbers::pi * i), std::sin(0.8 * std::numbers::pi * i), 0.0);
  EXPECT_FALSE(cut_polygon(star).simple) << "it winds twice about its middle";
}

TEST(Polygon, TheLargestDistanceFromThePlaneIsMeasured) {
  // corners at +-h above the mean plane of a unit square, whose extent is sqrt(2 + 4 h^2)
  const double h = 0.05;
  const PolygonCut cut = cut_polygon({{0, 0, h}, {1, 0, -h}, {1, 1, h}, {0, 1, -h}});
  EXPECT_NEAR(cut.warp, h / std::sqrt(2 + 4 * h * h), 1e-12);
  EXPECT_TRUE(cut.simple);
}

TEST(Polygon, WhatIsNotPlanarOrCrossesItselfIsReportedWithItsPlace) {
  const std::vector<Vec3> points{{0, 0, 0.05},  {1, 0, -0.05}, {1, 1, 0.05},
                                 {0, 1, -0.05}, {3, 0, 0},     {3, 1, 0}};
  std::vector<std::array<int, 3>> triangles;
  PolygonReport report;
  Provenance from = surface_provenance("a.obj");
  append_polygon(points, {1, 4, 5}, triangles, report);
  append_polygon(points, {0, 1, 1, 2, 3, 0}, triangles, report);
  append_polygon(points, {1, 4, 2, 5}, triangles, report);
  EXPECT_EQ(triangles.size(), 5u) << "a corner twice in a row counts once";
  from.element_number = {1, 2, 2, 3, 3};
  from.element_line = {7, 8, 8, 9, 9};
  expect_contains(warped_text(report, from), "a.obj:8: face 2: this polygon deviates from a plane by 3.5 %");
  expect_contains(crossing_text(report, from), "a.obj:9: face 3: the outline of this polygon crosses");
  EXPECT_EQ(warped_text({}, from) + crossing_text({}, from), "");
}

namespace {

std::string extruded(const std::string& caps) {
  std::string out;
  for (const double z : {0.0, 2.0})
    for (const Vec3& p : notched()) out += fmt::format("v {} {} {}\n", p.x(), p.y(), z);
  for (int i = 1; i <= 8; ++i) out += fmt::format("f {} {} {} {}\n", i, i % 8 + 1, i % 8 + 9, i + 8);
  return out + caps;
}

}  // namespace

TEST(Polygon, ASurfaceWithConcaveCapsEnclosesItsOwnVolume) {
  const TempFolder folder;
  // starts at a corner about which a fan would leave the outline
  folder.write("u.obj", extruded("f 3 2 1 8 7 6 5 4\nf 11 12 13 14 15 16 9 10\n"));
  MeshReport report;
  surface(file_spec("u.obj"), folder.path(), &report);
  EXPECT_NEAR(report.volume, 14.0, 1e-12);
  EXPECT_EQ(report.elements, 28);
}

TEST(Polygon, ASurfaceWithACrossedCapIsRefusedWithItsLine) {
  const TempFolder folder;
  folder.write("x.obj", extruded("f 3 2 1 8 7 5 6 4\nf 11 12 13 14 15 16 9 10\n"));
  expect_contains(error_of([&] { surface(file_spec("x.obj"), folder.path()); }),
                  "x.obj:25: face 9: the outline of this polygon crosses");
}
