#include "shapes/remesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mesh/surface_checks.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "shapes/contour.h"
#include "shapes/plane.h"
#include "shapes/solids.h"
#include "shapes/surface_facts.h"

using namespace palpate;
using shapes::Blueprint;

namespace {

Blueprint ball_plan(double radius, bool symmetric) {
  Blueprint plan;
  plan.inside = [radius](const Vec3& p) { return p.norm() - radius; };
  plan.low = Vec3::Constant(-1.3 * radius);
  plan.high = Vec3::Constant(1.3 * radius);
  plan.lattice = 0.07 * radius;
  plan.symmetric = symmetric;
  return plan;
}

// Closed form of a ring of revolution: volume 2 pi^2 R r^2, genus 1.
Blueprint ring_plan(double big, double small) {
  Blueprint plan;
  plan.inside = [=](const Vec3& p) { return std::hypot(std::hypot(p.x(), p.y()) - big, p.z()) - small; };
  plan.low = Vec3(-1.1 * (big + small), -1.1 * (big + small), -1.3 * small);
  plan.high = -plan.low;
  plan.lattice = 0.15 * small;
  plan.symmetric = true;
  return plan;
}

TEST(March, BallIsClosedOutwardsAndNearItsVolume) {
  TriMesh mesh = shapes::march(ball_plan(0.5, false));
  const mesh::MeshReport report = mesh::check_surface(mesh, mesh::surface_provenance("ball"));
  EXPECT_EQ(report.flipped, 0);
  EXPECT_EQ(euler_characteristic(mesh), 2);
  EXPECT_NEAR(mesh::enclosed_volume(mesh), std::numbers::pi / 6.0, 0.005);
}

// A ball whose function is eight times as steep in its upper half as its plan states: lattice blocks that
// contain its surface are skipped, which must not cause holes.
TEST(March, IsClosedWhereTheFunctionIsSteeperThanItsBound) {
  Blueprint plan = ball_plan(0.5, false);
  const auto ball = plan.inside;
  plan.inside = [ball](const Vec3& p) { return ball(p) * (1.0 + 7.0 * shapes::ramp(p.z(), -0.1, 0.1)); };
  plan.lipschitz = 1.0;
  TriMesh mesh = shapes::march(plan);
  EXPECT_NO_THROW(mesh::check_surface(mesh, mesh::surface_provenance("steep ball")));
  EXPECT_EQ(euler_characteristic(mesh), 2);
  EXPECT_NEAR(mesh::enclosed_volume(mesh), std::numbers::pi / 6.0, 0.005);
}

// Half a ball is open along x = 0 and nowhere else.
TEST(March, SymmetricBodyIsCutInItsPlane) {
  const TriMesh mesh = shapes::march(ball_plan(0.5, true));
  EXPECT_EQ(mesh.vertices.row(0).minCoeff(), 0.0);
  const shapes::CornerTable table(mesh.faces, static_cast<int>(mesh.vertices.cols()));
  ASSERT_EQ(table.last_ghost - table.first_ghost, 1);
  int rim = 0;
  table.around(table.first_ghost, [&](int h) {
    EXPECT_EQ(mesh.vertices(0, table.to(h)), 0.0);
    ++rim;
  });
  EXPECT_GT(rim, 20);
}

// The detector on which the other tests rely: two separate balls do not intersect, and two overlapping ones
// do, all along their circle of intersection.
TEST(SelfIntersections, AreFoundWhereTheyAre) {
  const TriMesh ball = shapes::contour(ball_plan(0.5, false), 700);
  for (const double distance : {1.1, 0.7}) {
    TriMesh two;
    two.vertices.resize(3, 2 * ball.vertices.cols());
    two.vertices << ball.vertices, ball.vertices.colwise() + Vec3(distance, 0, 0);
    two.faces.resize(3, 2 * ball.faces.cols());
    two.faces << ball.faces, ball.faces.array() + static_cast<int>(ball.vertices.cols());
    long looked_at = 0;
    const int found = self_intersections(two, &looked_at);
    EXPECT_GT(looked_at, 1000);
    if (distance > 1.0) {
      EXPECT_EQ(found, 0);
      continue;
    }
    const double circle = 2.0 * std::numbers::pi * std::sqrt(0.25 - 0.35 * 0.35),
                 edge = (vertex(ball, 0, 0) - vertex(ball, 0, 1)).norm();
    EXPECT_GT(found, circle / edge);
  }
}

// Volume of a sphere's inscribed triangles: V (1 - c h^2); the requested count is met, the triangles are
// good, every vertex lies on the sphere.
TEST(Contour, BallHasItsVolumeCountAndShape) {
  for (const bool symmetric : {false, true}) {
    const double radius = 0.5, exact = 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
    double missing[2];
    int i = 0;
    for (const int vertices : {700, 2800}) {
      TriMesh mesh = shapes::contour(ball_plan(radius, symmetric), vertices);
      const mesh::MeshReport report = mesh::check_surface(mesh, mesh::surface_provenance("ball"));
      EXPECT_EQ(report.flipped, 0);
      EXPECT_NEAR(static_cast<double>(mesh.vertices.cols()), vertices, symmetric ? 1.0 : 0.0);
      EXPECT_EQ(euler_characteristic(mesh), 2);
      EXPECT_GT(smallest_angle_deg(mesh), 25.0);
      EXPECT_LT((mesh.vertices.colwise().norm().array() - radius).abs().maxCoeff(), 1e-6);
      EXPECT_TRUE(!symmetric || is_its_mirror_image(mesh));
      missing[i++] = exact - mesh::enclosed_volume(mesh);
    }
    EXPECT_NEAR(missing[0] / missing[1], 4.0, 0.6);  // four times the vertices, half the edge
  }
}

TEST(Contour, RingKeepsItsHoleAndItsVolume) {
  TriMesh mesh = shapes::contour(ring_plan(0.4, 0.12), 3000);
  mesh::check_surface(mesh, mesh::surface_provenance("ring"));
  EXPECT_EQ(euler_characteristic(mesh), 0);
  const double exact = 2.0 * std::numbers::pi * std::numbers::pi * 0.4 * 0.12 * 0.12;
  EXPECT_NEAR(mesh::enclosed_volume(mesh) / exact, 1.0, 0.01);
  EXPECT_GT(smallest_angle_deg(mesh), 20.0);
  EXPECT_TRUE(is_its_mirror_image(mesh));
}

// The requested size halves on one side: edges there are half as long.
TEST(Contour, FollowsTheWantedSize) {
  Blueprint plan = ball_plan(0.5, false);
  plan.size = [](const Vec3& p) { return 1.0 - 0.5 * shapes::ramp(p.z(), -0.1, 0.1); };
  const TriMesh mesh = shapes::contour(plan, 3000);
  double above = 0.0, below = 0.0;
  int faces_above = 0, faces_below = 0;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const double z = (vertex(mesh, f, 0).z() + vertex(mesh, f, 1).z() + vertex(mesh, f, 2).z()) / 3.0,
                 edge = (vertex(mesh, f, 0) - vertex(mesh, f, 1)).norm();
    if (z > 0.15) above += edge, ++faces_above;
    if (z < -0.15) below += edge, ++faces_below;
  }
  EXPECT_NEAR((below / faces_below) / (above / faces_above), 2.0, 0.2);
}

// A square with a square hole: no triangle is inverted, and the area is exact because the rims are preserved.
TEST(Plane, FillsBetweenTwoLoops) {
  std::vector<shapes::Point2> outer, hole;
  const auto square = [](double half, int a_side, std::vector<shapes::Point2>& out) {
    const shapes::Point2 corner[4] = {{half, -half}, {half, half}, {-half, half}, {-half, -half}};
    for (int s = 0; s < 4; ++s)
      for (int i = 0; i < a_side; ++i)
        out.push_back(corner[s] + (corner[(s + 1) % 4] - corner[s]) * i / a_side);
  };
  square(1.0, 20, outer);
  square(0.4, 8, hole);
  const int inside = shapes::vertices_between(outer, hole, 0.1);
  const TriMesh mesh = shapes::between(outer, hole, inside);
  EXPECT_EQ(mesh.vertices.cols(), 80 + 32 + inside);
  EXPECT_EQ(mesh.faces.cols(), 2 * inside + 80 + 32);  // Euler's formula for a ring
  double area = 0.0;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const double a =
        0.5 * (vertex(mesh, f, 1) - vertex(mesh, f, 0)).cross(vertex(mesh, f, 2) - vertex(mesh, f, 0)).z();
    EXPECT_GT(a, 0.0);
    area += a;
  }
  EXPECT_NEAR(area, 4.0 - 0.64, 1e-12);
  EXPECT_GT(smallest_angle_deg(mesh), 20.0);
  for (int i = 0; i < 80; ++i)
    EXPECT_EQ(Vec3(mesh.vertices.col(i)),
              Vec3(outer[static_cast<std::size_t>(i)].x(), outer[static_cast<std::size_t>(i)].y(), 0));
}

// A flip there and back, a split and its collapse: the surface remains closed with each edge in two faces.
TEST(CornerTable, OperationsKeepTheSurfaceClosed) {
  Faces octahedron(3, 8);
  octahedron << 0, 1, 2, 3, 1, 2, 3, 0, 1, 2, 3, 0, 0, 1, 2, 3, 4, 4, 4, 4, 5, 5, 5, 5;
  shapes::CornerTable table(octahedron, 6);
  const auto closed = [&] {
    int faces = 0;
    for (int h = 0; h < static_cast<int>(table.origin.size()); ++h) {
      if (table.gone(h)) continue;
      EXPECT_EQ(table.twin[table.twin[h]], h);
      EXPECT_EQ(table.from(table.twin[h]), table.to(h));
      EXPECT_EQ(table.to(table.twin[h]), table.from(h));
      faces += h % 3 == 0 ? 1 : 0;
    }
    return faces;
  };
  EXPECT_EQ(closed(), 8);
  ASSERT_TRUE(table.can_flip(0));
  table.flip(0);
  EXPECT_EQ(closed(), 8);
  const int m = table.add_vertex();
  table.split(0, m);
  EXPECT_EQ(closed(), 10);
  EXPECT_EQ(table.valence(m), 4);
  int possible = -1;  // towards a vertex whose collapse leaves each other vertex three neighbours
  table.around(m, [&](int h) { possible = table.can_collapse(h) ? h : possible; });
  ASSERT_GE(possible, 0);
  table.collapse(possible);
  EXPECT_EQ(closed(), 8);
}

// Two faces with the same direction along an edge, and an edge in three faces.
TEST(CornerTable, RefusesSurfacesThatAreNone) {
  Faces same(3, 2), three(3, 3);
  same << 0, 0, 1, 1, 2, 3;
  three << 0, 1, 0, 1, 0, 1, 2, 3, 4;
  EXPECT_THROW(shapes::CornerTable(same, 4), InternalError);
  EXPECT_THROW(shapes::CornerTable(three, 5), InternalError);
}

// A tetrahedron is minimal: a collapse would flatten it, a flip would double an edge.
TEST(CornerTable, RefusesWhatWouldBreakTheSurface) {
  Faces faces(3, 4);
  faces << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  const shapes::CornerTable table(faces, 4);
  for (int h = 0; h < 12; ++h) {
    EXPECT_FALSE(table.can_flip(h));
    EXPECT_FALSE(table.can_collapse(h));
  }
}

}  // namespace
