#include "proxy/decompose_solid.h"

#include <gtest/gtest.h>

#include <random>

#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "proxy/hull.h"
#include "proxy/owners.h"
#include "tools.h"

using namespace palpate;
using proxy::decompose_solid;
using tools::fork;
using tools::torus;

namespace {

const Quat kTurn = Quat(0.8, -0.3, 0.4, 0.3).normalized();

TriMesh rotated(TriMesh surface) {
  surface.vertices = (kTurn.toRotationMatrix() * surface.vertices).colwise() + Vec3(3, -1, 2);
  return surface;
}

/// A cube of edge 6 with a slot in its upper half: its inside is far from its surface.
TriMesh slotted_cube() {
  return tools::of_cubes({12, 12, 12}, 0.5, [](int i, int, int k) { return k < 6 || i < 5 || i > 6; });
}

/// A ball with a spherical cavity, whose surface is oriented inwards.
TriMesh hollow_ball() {
  TriMesh out = mesh::sphere(1.0, 10);
  const TriMesh inner = mesh::sphere(0.5, 8);
  const Eigen::Index n = out.vertices.cols(), m = out.faces.cols();
  out.vertices.conservativeResize(3, n + inner.vertices.cols());
  out.vertices.rightCols(inner.vertices.cols()) = inner.vertices;
  out.faces.conservativeResize(3, m + inner.faces.cols());
  for (Eigen::Index f = 0; f < inner.faces.cols(); ++f)
    out.faces.col(m + f) = Eigen::Vector3i(inner.faces(0, f), inner.faces(2, f), inner.faces(1, f)).array() +
                           static_cast<int>(n);
  return out;
}

bool is_inside(const TriMesh& surface, const Vec3& p) {
  std::vector<int> all(static_cast<std::size_t>(surface.faces.cols()));
  for (std::size_t f = 0; f < all.size(); ++f) all[f] = static_cast<int>(f);
  return mesh::winding_number(surface, all, p) > 0.5;
}

/// Distance of a point from the nearest hull, each inflated as in the set; not positive inside one of them.
double outside_all(const proxy::ProxySet& set, const std::vector<ProxyHull>& hulls, const Vec3& p) {
  double nearest = 1e300;
  for (int i = 0; i < set.size(); ++i) {
    const proxy::Hull hull(hulls[static_cast<std::size_t>(i)].corners), point{Points(p)};
    nearest = std::min(nearest, proxy::nearest_difference(point, hull).norm() - set.state(i).inflation);
  }
  return nearest;
}

proxy::ProxySet set_of(const TriMesh& surface, const std::vector<ProxyHull>& hulls) {
  LayeredModel model;
  model.skin = surface;
  model.proxies = hulls;
  return proxy::ProxySet(model);
}

std::string error_of(const TriMesh& surface, const proxy::SolidOptions& options) {
  try {
    decompose_solid(surface, options);
  } catch (const Error& e) { return e.what(); }
  return "nothing was refused";
}

}  // namespace

// Pruning depends on this property: random points inside, most of them far from the surface, lie in an
// inflated hull, for any number of hulls.
TEST(DecomposeSolid, CoversTheInside) {
  std::mt19937 random(3);
  const TriMesh solids[] = {rotated(torus(1.0, 0.3, 40, 20)), rotated(fork(4)), slotted_cube(),
                            rotated(slotted_cube()), hollow_ball()};
  for (const TriMesh& solid : solids) {
    const Vec3 low = solid.vertices.rowwise().minCoeff(), high = solid.vertices.rowwise().maxCoeff();
    std::vector<Vec3> points;
    while (points.size() < 300) {
      std::uniform_real_distribution<double> in(0.0, 1.0);
      const Vec3 p = low + Vec3(in(random), in(random), in(random)).cwiseProduct(high - low);
      if (is_inside(solid, p)) points.push_back(p);
    }
    for (const int count : {1, 8, 64}) {
      const auto hulls = decompose_solid(solid, {.count = count, .tolerance = 0.0});
      EXPECT_LE(static_cast<int>(hulls.size()), count);
      EXPECT_GT(static_cast<int>(hulls.size()), count / 2) << "with no tolerance a hollow solid is cut on";
      EXPECT_NO_THROW(proxy::owner_of_faces(solid.faces, solid.vertices.cols(), hulls));
      const proxy::ProxySet set = set_of(solid, hulls);
      double most = -1.0;
      for (const Vec3& p : points) most = std::max(most, outside_all(set, hulls, p));
      EXPECT_LT(most, 1e-9) << &solid - solids << " in " << count;
    }
  }
}

// The number of segments follows from the tolerance: over a segment of angle t the hull leaves the inner side
// along the chord, (R - r)(1 - cos(t/2)) away, which must be below the tolerance, and need not be below a
// quarter of it, because a cut halves t. The hole remains open.
TEST(DecomposeSolid, ATorusBecomesARing) {
  constexpr double R = 1.0, r = 0.3, tolerance = 0.02;
  const TriMesh ring = rotated(torus(R, r, 96, 32));
  proxy::DecomposeReport report;
  const auto hulls = decompose_solid(ring, {.tolerance = tolerance}, &report);
  const double size = report.skin_size, most = 2 * std::acos(1.0 - tolerance * size / (R - r)),
               least = 2 * std::acos(1.0 - 0.25 * tolerance * size / (R - r));
  EXPECT_GE(static_cast<double>(hulls.size()), std::floor(2 * M_PI / most));
  EXPECT_LE(static_cast<double>(hulls.size()), std::ceil(2 * M_PI / least));
  EXPECT_LT(report.hull_volume, 1.15 * report.skin_volume);
  EXPECT_LT(report.largest_gap, 1.5 * tolerance * size);
  EXPECT_LT(report.largest_outside, 0.02 * size);
  const proxy::ProxySet set = set_of(ring, hulls);
  for (int i = 0; i < 24; ++i)
    EXPECT_GT(
        outside_all(set, hulls, kTurn * Vec3(0.5 * std::cos(i), 0.5 * std::sin(i), 0.0) + Vec3(3, -1, 2)),
        0.05)
        << i;
  const auto one = decompose_solid(ring, {.count = 1});
  EXPECT_LT(outside_all(set_of(ring, one), one, Vec3(3, -1, 2)), 0.0) << "one hull closes it";
}

// Planes through the fork's corners: its parts are convex, so that the hulls have its volume, 7, for any
// rotation; the gap between the prongs remains open.
TEST(DecomposeSolid, AForkBecomesItsParts) {
  for (const TriMesh& tool : {fork(8), rotated(fork(8))}) {
    proxy::DecomposeReport report;
    const auto hulls = decompose_solid(tool, {}, &report);
    EXPECT_GE(hulls.size(), 3u);
    EXPECT_LE(hulls.size(), 5u);
    EXPECT_NEAR(report.skin_volume, 7.0, 1e-9);
    EXPECT_NEAR(report.hull_volume, 7.0, 1e-6);
    EXPECT_LT(report.largest_outside, 1e-6);
  }
  const auto hulls = decompose_solid(fork(8));
  const proxy::ProxySet set = set_of(fork(8), hulls);
  EXPECT_NEAR(outside_all(set, hulls, Vec3(0, 0, 1)), 0.5, 1e-5);
  EXPECT_NEAR(outside_all(set, hulls, Vec3(0.1, 0, 1.9)), 0.1, 1e-5);
}

TEST(DecomposeSolid, WhatIsConvexStaysWhole) {
  for (const TriMesh& solid :
       {mesh::sphere(0.02, 8), mesh::box_surface(Vec3(1, 2, 3), {1, 2, 3}),
        mesh::cylinder_surface(0.1, 1.0, 0.05), rotated(mesh::box_surface(Vec3(1, 1, 1), {5, 5, 5}))}) {
    const auto hulls = decompose_solid(solid);
    EXPECT_EQ(hulls.size(), 1u);
    EXPECT_LE(hulls[0].corners.cols(), 32);
  }
}

TEST(DecomposeSolid, TheSameSurfaceGivesTheSameHulls) {
  const auto first = decompose_solid(torus(1.0, 0.3, 40, 20)),
             second = decompose_solid(torus(1.0, 0.3, 40, 20));
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t p = 0; p < first.size(); ++p) {
    EXPECT_EQ(first[p].members, second[p].members);
    EXPECT_TRUE((first[p].corners.array() == second[p].corners.array()).all());
  }
}

TEST(DecomposeSolid, RefusesWhatItCannotDo) {
  const TriMesh ball = mesh::sphere(1.0, 2);
  EXPECT_NE(error_of(ball, {.count = 0}).find("count = 0 must be at least 1"), std::string::npos);
  EXPECT_NE(error_of(ball, {.max_corners = 3}).find("max_corners = 3 must be at least 4"), std::string::npos);
  EXPECT_NE(error_of(ball, {.tolerance = -1}).find("tolerance"), std::string::npos);
  EXPECT_NE(error_of(TriMesh{}, {}).find("no faces"), std::string::npos);
}
