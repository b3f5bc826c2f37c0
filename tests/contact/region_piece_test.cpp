#include "contact/region_piece.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "palpate/dynamics/state.h"
#include "palpate/mesh/generators.h"
#include "sheets.h"

using namespace contact_tests;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A surface as a region's mesh, its faces in any order that keeps those of a proxy together.
struct Meshed {
  TriMesh surface;
  std::vector<int> proxy_of_face, faces, local;
  std::unique_ptr<ImageSide> side;
  RegionMesh mesh;

  Meshed(TriMesh of, std::vector<int> proxies, unsigned seed = 0)
      : surface(std::move(of)), proxy_of_face(std::move(proxies)), faces(proxy_of_face.size()) {
    side = rigid_side(surface, 0, fixed_frame());
    const dynamics::State state;
    side->update(state.view());
    std::iota(faces.begin(), faces.end(), 0);
    if (seed != 0) std::shuffle(faces.begin(), faces.end(), std::mt19937(seed));
    std::stable_sort(faces.begin(), faces.end(), [&](int f, int g) {
      return proxy_of_face[static_cast<std::size_t>(f)] < proxy_of_face[static_cast<std::size_t>(g)];
    });
    mesh.take(*side, faces, proxy_of_face, local);
  }
};

Mat3 corners(const TriMesh& mesh, const ContactAxes& axes, int face) {
  Mat3 out;
  for (int k = 0; k < 3; ++k) out.col(k) = axes.in_axes(mesh.vertices.col(mesh.faces(k, face)));
  return out;
}
AxisBox box_of(const Mat3& corners) { return {corners.rowwise().minCoeff(), corners.rowwise().maxCoeff()}; }
double area_along(const Mat3& corners) {
  return (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).z();
}
bool meet(const AxisBox& p, const AxisBox& q) {
  return (p.low.array() <= q.high.array()).all() && (p.high.array() >= q.low.array()).all();
}

/// The faces of a surface that there still are, one by one.
struct Remaining {
  const TriMesh& mesh;
  const ContactAxes& axes;
  std::set<int> faces;

  AxisBox bounds() const {
    AxisBox out;
    for (const int face : faces) {
      const AxisBox box = box_of(corners(mesh, axes, face));
      out.low = out.low.cwiseMin(box.low);
      out.high = out.high.cwiseMax(box.high);
    }
    return out;
  }
  AxisBox cut(const AxisBox& window) {
    std::erase_if(faces, [&](int face) { return !meet(box_of(corners(mesh, axes, face)), window); });
    return bounds();
  }
};

std::set<int> in_surface(const Meshed& of, const std::vector<int>& faces) {
  std::set<int> out;
  for (const int face : faces) out.insert(of.mesh.surface_faces()[static_cast<std::size_t>(face)]);
  EXPECT_EQ(out.size(), faces.size()) << "each once";
  return out;
}

std::vector<int> cells(const TriMesh& mesh) {  // a proxy for each quarter of the plane, and above or below
  std::vector<int> out;
  for (const auto corner : mesh.faces.colwise()) {
    const Vec3 x = mesh.vertices.col(corner[0]);
    out.push_back((x.x() > 0.0) + 2 * (x.y() > 0.0) + 4 * (x.z() > 0.0));
  }
  return out;
}

}  // namespace

// Two balls that overlap off their middles, seen along a slanted normal, whole and only by some proxies: the
// faces of the window are those that the rule gives face by face, in whatever order they stand.
TEST(RegionPiece, SeesTheFacesThatReachIntoTheWindow) {
  TriMesh upper = mesh::sphere(1.0, 14), lower = mesh::sphere(1.3, 11);
  lower.vertices.colwise() += Vec3(0.4, -0.3, -2.05);
  const ContactAxes axes(Vec3(0.1, 0.2, -0.9), Vec3(-0.3, 0.2, 1.0).normalized());
  constexpr double kGap = 0.03;
  for (const unsigned seed : {0u, 5u})
    for (const std::set<int>& own : {std::set<int>{0, 1, 2, 3, 4, 5, 6, 7}, {1}, {0, 3}}) {
      const Meshed a(upper, cells(upper), seed), b(lower, cells(lower), seed);
      RegionPiece whole, piece_a, piece_b;
      whole.take(a.mesh);
      piece_a.take_part(whole, [&](int proxy) { return own.contains(proxy); });
      piece_b.take(b.mesh);
      Patch patch_a, patch_b;
      const ContactWindow window = fit_window(piece_a, piece_b, axes, kGap, patch_a, patch_b);

      Remaining of_a{upper, axes, {}}, of_b{lower, axes, {}};
      for (int f = 0; f < upper.faces.cols(); ++f)
        if (own.contains(a.proxy_of_face[static_cast<std::size_t>(f)]) &&
            area_along(corners(upper, axes, f)) < 0)
          of_a.faces.insert(f);
      AxisBox box_a = of_a.bounds();
      for (int f = 0; f < lower.faces.cols(); ++f)
        if (area_along(corners(lower, axes, f)) > 0) of_b.faces.insert(f);
      AxisBox box_b =
          of_b.cut({Vec3(box_a.low - Vec3(0, 0, kGap)), Vec3(box_a.high.x(), box_a.high.y(), kInfinity)});
      for (int i = 0; i < 3; ++i) {
        AxisBox to_a{box_a.low.cwiseMax(box_b.low), box_a.high.cwiseMin(box_b.high)}, to_b = to_a;
        to_a.low.z() = -kInfinity;
        to_a.high.z() = box_b.high.z() + kGap;
        to_b.low.z() = box_a.low.z() - kGap;
        to_b.high.z() = kInfinity;
        box_a = of_a.cut(to_a);
        box_b = of_b.cut(to_b);
      }
      ASSERT_GT(of_a.faces.size(), 20u);
      ASSERT_LT(of_a.faces.size(), own.size() * static_cast<std::size_t>(upper.faces.cols()) / 16);
      ASSERT_GT(of_b.faces.size(), 20u);
      EXPECT_EQ(in_surface(a, patch_a.visible), of_a.faces);
      EXPECT_EQ(in_surface(b, patch_b.visible), of_b.faces);
      constexpr double kRounding = 1e-14;
      EXPECT_LT((window.low - box_a.low.cwiseMax(box_b.low).head<2>()).norm(), kRounding);
      EXPECT_LT((window.high - box_a.high.cwiseMin(box_b.high).head<2>()).norm(), kRounding);
      EXPECT_LT(window.near, box_a.low.z() - kGap);
      EXPECT_GT(window.far, box_b.high.z() + kGap);
      for (int f = 0; f < patch_a.faces->cols(); ++f)
        for (int k = 0; k < 3; ++k)
          EXPECT_LT(
              (patch_a.uvw.col((*patch_a.faces)(k, f)) - corners(upper, axes, piece_a.face_of(f)).col(k))
                  .norm(),
              kRounding);
    }
}

// Chunks that are wholly seen, wholly turned away, and with faces of both kinds: which of their faces are
// seen and which are turned away is what the area of each face says.
TEST(RegionPiece, SeesOfEveryChunkTheFacesThatFaceTheCamera) {
  const TriMesh ball = mesh::sphere(1.0, 14);
  const ContactAxes axes(Vec3(0.1, 0.2, -0.9), Vec3(-0.3, 0.2, 1.0).normalized());
  std::vector<int> zones;  // a proxy each: lower cap, belt, upper cap
  for (int f = 0; f < ball.faces.cols(); ++f) {
    const double height = axes.normal().dot(ball.vertices.col(ball.faces(0, f)));
    zones.push_back(height < -0.4 ? 0 : height > 0.4 ? 2 : 1);
  }
  const AxisBox all{Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity)};
  for (const unsigned seed : {0u, 5u})
    for (const double side : {1.0, -1.0}) {
      const Meshed of(ball, zones, seed);
      const auto faces_camera = [&](int face) { return side * area_along(corners(ball, axes, face)) > 0.0; };
      int wholly_seen = 0, wholly_away = 0, mixed = 0;
      for (const RegionMesh::Chunk& chunk : of.mesh.chunks()) {
        int count = 0;
        for (int f = chunk.first; f < chunk.end; ++f)
          count += faces_camera(of.mesh.surface_faces()[static_cast<std::size_t>(f)]);
        ++(count == chunk.end - chunk.first ? wholly_seen : count == 0 ? wholly_away : mixed);
      }
      EXPECT_GT(wholly_seen, 3);
      EXPECT_GT(wholly_away, 3);
      EXPECT_GT(mixed, 3);
      std::set<int> seen, away;
      AxisBox bounds;
      for (int f = 0; f < ball.faces.cols(); ++f) {
        (faces_camera(f) ? seen : away).insert(f);
        if (!faces_camera(f)) continue;
        const AxisBox box = box_of(corners(ball, axes, f));
        bounds.low = bounds.low.cwiseMin(box.low);
        bounds.high = bounds.high.cwiseMax(box.high);
      }
      RegionPiece piece;
      piece.take(of.mesh);
      Patch patch;
      const AxisBox found = piece.see(axes, side, all);
      constexpr double kRounding = 1e-14;
      EXPECT_LT((found.low - bounds.low).norm(), kRounding);
      EXPECT_LT((found.high - bounds.high).norm(), kRounding);
      piece.finish(all, patch);
      EXPECT_EQ(in_surface(of, patch.visible), seen);
      EXPECT_EQ(in_surface(of, *patch.away), away);
    }
}

// Of a box seen from below what a region holds is seen where it faces down; what its body has elsewhere is
// never seen, and where it faces up the body is left.  Beyond the window none of this matters.
TEST(RegionPiece, OtherFacesOfItsBodyAreWhereItIsLeft) {
  const TriMesh box = mesh::box_surface(Vec3(1, 1, 1), {2, 2, 2});
  std::vector<int> proxies;  // the left half is the region's own
  for (Eigen::Index f = 0; f < box.faces.cols(); ++f)
    proxies.push_back(box.vertices.col(box.faces(0, f)).x() + box.vertices.col(box.faces(1, f)).x() +
                                  box.vertices.col(box.faces(2, f)).x() <
                              0.0
                          ? 0
                          : 1);
  const Meshed of(box, proxies);
  const ContactAxes axes(Vec3::Zero(), Vec3::UnitZ());
  RegionPiece whole, left;
  whole.take(of.mesh);
  left.take_part(whole, [](int proxy) { return proxy == 0; });
  const AxisBox all{Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity)};
  Patch patch;
  const auto up = [&] {
    long count = 0;
    for (const int f : *patch.away) {
      EXPECT_LE(-area_along(corners(box, axes, left.face_of(f))), 0.0);
      count += area_along(corners(box, axes, left.face_of(f))) > 0.0;
    }
    return count;
  };
  const AxisBox bounds = left.see(axes, -1.0, all);
  EXPECT_EQ(bounds.low, Vec3(-0.5, -0.5, -0.5));
  EXPECT_EQ(bounds.high, Vec3(0.5, 0.0, -0.5));  // v is x, u is -y
  left.finish(all, patch);
  ASSERT_EQ(patch.visible.size(), 4u);  // half of the bottom's eight
  for (const int f : patch.visible) {
    EXPECT_LT(area_along(corners(box, axes, left.face_of(f))), 0.0);
    EXPECT_EQ(proxies[static_cast<std::size_t>(left.face_of(f))], 0);
  }
  ASSERT_TRUE(patch.away);
  EXPECT_EQ(up(), 8);  // the top, of both halves
  left.see(axes, -1.0, all);
  left.finish({Vec3(-1.0, -1.0, -1.0), Vec3(1.0, -0.1, 1.0)}, patch);
  EXPECT_EQ(up(), 4);
  left.see(axes, -1.0, all);
  left.finish({Vec3(-1.0, -1.0, -1.0), Vec3(1.0, 1.0, 0.4)}, patch);
  EXPECT_EQ(up(), 0);
}
