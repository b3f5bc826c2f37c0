#include "proxy/decompose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "palpate/core/error.h"
#include "proxy/convex_hull.h"
#include "proxy/owners.h"
#include "shapes.h"

using namespace palpate;
using proxy::decompose;

namespace {

std::string error_of(const LayeredModel& model, const proxy::DecomposeOptions& options) {
  try {
    decompose(model, options);
  } catch (const Error& e) { return e.what(); }
  return "nothing was refused";
}

}  // namespace

// Hulls of the cube's corners with inner points, of a square, a line and a point: corners, planes and volume
// are known.
TEST(ConvexHull, SetsOfEveryDimension) {
  Points cube(3, 10);
  for (int i = 0; i < 8; ++i)
    cube.col(i) = Vec3(i & 1, (i >> 1) & 1, (i >> 2) & 1) * 1e-3 + Vec3::Constant(7.0);
  cube.col(8) = Vec3::Constant(7.0005);
  cube.col(9) = Vec3(7.0002, 7.0009, 7.0001);
  auto hull = proxy::convex_hull(cube);
  EXPECT_EQ(hull.corners, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_NEAR(hull.volume, 1e-9, 1e-16);
  EXPECT_NEAR(hull.beyond(Vec3(7.0005, 7.0005, 7.003)), 2e-3, 1e-12);
  EXPECT_NEAR(hull.beyond(Vec3::Constant(7.0005)), -5e-4, 1e-12);

  const Points square = cube.leftCols(4);  // z = 7
  hull = proxy::convex_hull(square);
  EXPECT_EQ(hull.corners, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(hull.volume, 0.0);
  EXPECT_NEAR(hull.beyond(Vec3(7.0005, 7.0005, 7.003)), 3e-3, 1e-12);
  EXPECT_NEAR(hull.beyond(Vec3(7.0015, 7.0005, 7.0)), 5e-4, 1e-12);
  EXPECT_NEAR(hull.beyond(Vec3(7.0005, 7.0005, 7.0)), 0.0, 1e-12);

  Points line(3, 4);
  line << 0, 1, 3, 2, 0, 1, 3, 2, 0, 0, 0, 0;
  hull = proxy::convex_hull(line);
  EXPECT_EQ(hull.corners, (std::vector<int>{0, 2}));
  EXPECT_NEAR(hull.beyond(Vec3(4, 4, 0)), std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(hull.beyond(Vec3(1, 1, 0)), 0.0, 1e-12);

  const Points point = Points::Constant(3, 3, 2.0);
  hull = proxy::convex_hull(point);
  EXPECT_EQ(hull.corners, std::vector<int>{0});
  EXPECT_NEAR(hull.beyond(Vec3(2, 2, 3)), 1.0, 1e-12);
  EXPECT_THROW(proxy::convex_hull(Points(3, 0)), InternalError);
}

// With enough corners the hull is complete; with fewer corners its error decreases monotonically with their
// number.
TEST(ConvexHull, GreedyCornersMissLessAndLess) {
  const Points points = mesh::sphere(1.0, 8).vertices;
  double before = 1.0;
  for (const int count : {4, 8, 16, 32, 64, 642}) {
    const auto corners = proxy::greedy_corners(points, count, 0.0);
    ASSERT_LE(static_cast<int>(corners.size()), count);
    const auto hull = proxy::convex_hull(points(Eigen::all, corners));
    double most = -1.0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) most = std::max(most, hull.beyond(points.col(i)));
    EXPECT_LE(most, before + 1e-12) << count;
    before = most;
  }
  EXPECT_NEAR(before, 0.0, 1e-12);
  EXPECT_LT(proxy::greedy_corners(points, 300, 0.05).size(), 150u);  // the tolerance ends it earlier
}

TEST(Decompose, EveryVertexFaceAndTetrahedronHasAProxy) {
  const LayeredModel model = bumpy_ball(1.0, 0.2, 24);
  for (const int count : {1, 8, 60}) {
    proxy::DecomposeReport report;
    LayeredModel whole = model;
    whole.proxies = decompose(model, {.count = count}, &report);
    EXPECT_LE(static_cast<int>(whole.proxies.size()), count);
    EXPECT_GE(static_cast<int>(whole.proxies.size()), count - count / 10);
    // throws if one has no owner
    const auto faces = proxy::owner_of_faces(model.skin.faces, model.skin.vertices.cols(), whole.proxies);
    EXPECT_EQ(std::set<int>(faces.begin(), faces.end()).size(), whole.proxies.size());
    const auto tets =
        proxy::owner_of_tets(model.tets.tets, model.tets.nodes.cols(), model.embedding,
                             proxy::owner_of_vertices(model.skin.vertices.cols(), whole.proxies));
    std::vector<proxy::ConvexHull> hulls;
    for (const auto& p : whole.proxies) {
      EXPECT_TRUE(std::is_sorted(p.members.begin(), p.members.end()));
      EXPECT_LE(p.corners.cols(), 32);
      EXPECT_EQ(p.bone, -1);
      hulls.push_back(proxy::convex_hull(p.corners));
      // in convex position
      EXPECT_EQ(static_cast<Eigen::Index>(hulls.back().corners.size()), p.corners.cols());
    }
    double outside = 0.0;
    for (std::size_t t = 0; t < tets.size(); ++t)
      for (int k = 0; k < 4; ++k)
        outside = std::max(outside, hulls[static_cast<std::size_t>(tets[t])].beyond(model.tets.nodes.col(
                                        model.tets.tets(k, static_cast<Eigen::Index>(t)))));
    for (std::size_t p = 0; p < hulls.size(); ++p)
      for (const int v : whole.proxies[p].members) {
        outside = std::max(outside, hulls[p].beyond(model.skin.vertices.col(v)));
        EXPECT_LE(hulls[p].beyond(model.skin.vertices.col(v)), report.hulls[p].outside + 1e-12);
      }
    // Clusters of skin vertices leave 0.01-0.02 R outside for 16 to 32 hulls of 32 vertices; a single hull
    // has 32 vertices for the whole ball
    EXPECT_LT(outside, count == 1 ? 0.2 : count == 8 ? 0.06 : 0.02) << count;
    EXPECT_GT(report.hull_volume, 0.8 * report.skin_volume);
    // a wedge of diameter 0.46 includes whole elements of 0.2: (0.46 + 0.2)^2 / 0.46^2 = 2.06
    EXPECT_LT(report.hull_volume, 2.2 * report.skin_volume);
    EXPECT_GE(report.largest_gap, 0.0);
    EXPECT_LT(report.largest_gap, 0.15);
  }
}

TEST(Decompose, TheSameModelGivesTheSameHulls) {
  const LayeredModel model = bumpy_ball(1.0, 0.25, 20);
  const auto first = decompose(model, {.count = 20}), second = decompose(model, {.count = 20});
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t p = 0; p < first.size(); ++p) {
    EXPECT_EQ(first[p].members, second[p].members);
    EXPECT_TRUE((first[p].corners.array() == second[p].corners.array()).all());
  }
}

TEST(Decompose, ASkeletonCutsFirst) {
  const LayeredModel model = bar_on_bones({8, 2, 2});
  for (const int count : {1, 2, 10}) {
    const auto proxies = decompose(model, {.count = count});
    EXPECT_EQ(static_cast<int>(proxies.size()), std::max(count, 2));
    for (const auto& p : proxies) {
      ASSERT_TRUE(p.bone == 0 || p.bone == 1);
      EXPECT_LT((p.bone == 0 ? 1 : -1) * p.corners.row(0).mean(), 0.0);
    }
  }
}

// Clusters on a box's flat faces have flat hulls if there are no tetrahedra behind them.
TEST(Decompose, FlatPatchesOfASkinAlone) {
  LayeredModel model;
  model.skin = mesh::box_surface(Vec3(1, 1, 1), {6, 6, 6});
  proxy::DecomposeReport report;
  const auto proxies = decompose(model, {.count = 6, .normal_weight = 4.0}, &report);
  EXPECT_EQ(proxies.size(), 6u);
  EXPECT_LT(report.largest_outside, 1e-12);
  EXPECT_NO_THROW(proxy::owner_of_faces(model.skin.faces, model.skin.vertices.cols(), proxies));
}

TEST(Decompose, RefusesWhatItCannotDo) {
  LayeredModel model = bar_on_bones({2, 1, 1});
  EXPECT_NE(error_of(model, {.count = 0}).find("count = 0 must be at least 1"), std::string::npos);
  EXPECT_NE(error_of(model, {.max_corners = 3}).find("max_corners = 3 must be at least 4"),
            std::string::npos);
  EXPECT_NE(error_of(model, {.normal_weight = -1}).find("normal weight"), std::string::npos);
  EXPECT_NE(error_of(model, {.tolerance = -1}).find("tolerance"), std::string::npos);
  model.embedding = {};
  EXPECT_NE(error_of(model, {}).find("are embedded"), std::string::npos);
  EXPECT_NE(error_of(LayeredModel{}, {}).find("no skin"), std::string::npos);

  model = bar_on_bones({2, 1, 1});
  auto proxies = decompose(model, {.count = 4});
  proxies[1].members.clear();
  EXPECT_THROW(proxy::owner_of_faces(model.skin.faces, model.skin.vertices.cols(), proxies), Error);
}
