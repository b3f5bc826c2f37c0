// Nearest points and inside tests against a search through all triangles, over shapes with sharp edges,
// relief and handles, and meshes from practice (PALPATE_TEST_DATA).
#include <cstdlib>
#include <filesystem>

#include "bodies.h"
#include "mesh/readers.h"
#include "palpate/mesh/source.h"

using namespace distance_tests;

namespace {

Foot brute_force(const Surface& surface, const Vec3& x) {
  Foot best;
  best.at.distance2 = INFINITY;
  for (int f = 0; f < surface.skin().face_count(); ++f) {
    const TrianglePoint at = surface.nearest_on_face(f, x);
    if (at.distance2 < best.at.distance2) best = {f, at};
  }
  return best;
}

std::vector<std::pair<std::string, TriMesh>> meshes() {
  std::vector<std::pair<std::string, TriMesh>> out = {{"bumpy sphere", bumpy_sphere(0.1, 12, 0.15)},
                                                      {"box", mesh::box_surface({0.1, 0.2, 0.05}, {2, 4, 1})},
                                                      {"pumpkin", shape_skin("pumpkin", 6000)},
                                                      {"gear", shapes::make("gear").skin}};
  if (const char* folder = std::getenv("PALPATE_TEST_DATA"))
    for (const char* name : {"spot.obj", "femur.obj", "patella.obj"})
      if (const auto file = std::filesystem::path(folder) / name; std::filesystem::exists(file)) {
        MeshSpec spec;
        spec.file = file.string();
        out.emplace_back(name, mesh::surface(spec, ""));
      }
  return out;
}

}  // namespace

TEST(NearestOnTriangle, MeetsTheConditionOfANearestPoint) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto point = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  int features[3] = {};
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = point(), b = point(), c = i % 3 ? point() : Vec3(a + 0.4 * (b - a) + 1e-3 * point()),
               x = point();
    const TrianglePoint at = nearest_on_triangle(a, b, c, x);
    // y is the point of a convex set nearest to x exactly if no point z of the set has (x - y) . (z - y) > 0.
    const Vec3 y = x - at.away;
    for (const Vec3& z : {a, b, c}) EXPECT_LE(at.away.dot(z - y), 1e-12);
    EXPECT_NEAR(at.weights.sum(), 1.0, 1e-14);
    EXPECT_GE(at.weights.minCoeff(), 0.0);
    EXPECT_LT((x - at.away - at.weights[0] * a - at.weights[1] * b - at.weights[2] * c).norm(), 1e-13);
    ++features[(at.weights.array() == 0.0).count()];
  }
  for (const int count : features) EXPECT_GT(count, 20);
}

TEST(NearestOnTriangle, DegenerateOnesAreEdgesAndPoints) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), x(0.25, 1, 0);
  EXPECT_DOUBLE_EQ(nearest_on_triangle(a, b, Vec3(0.5, 0, 0), x).distance2, 1.0);
  EXPECT_DOUBLE_EQ(nearest_on_triangle(a, a, a, x).distance2, 1.0625);
}

TEST(DistanceSurface, NearestPointIsThatOfAllTrianglesWhateverBoundsTheSearch) {
  std::mt19937 random(11);
  for (const auto& [name, mesh] : meshes()) {
    const Body body = shell(mesh);
    Surface surface(body.skin);
    surface.move(body.at());
    const Vec3 low = body.nodes.rowwise().minCoeff(), high = body.nodes.rowwise().maxCoeff();
    std::uniform_real_distribution<double> share(-0.1, 1.1), small(-0.02, 0.02);
    std::uniform_int_distribution<int> any(0, body.skin.face_count() - 1);
    int inside = 0;
    for (int i = 0; i < 200; ++i) {
      Vec3 x;
      if (i % 2)  // near the skin, where many features compete
        x = surface.corner(any(random), 0) +
            (high - low).norm() * Vec3(small(random), small(random), small(random));
      else
        x = low + (high - low).cwiseProduct(Vec3(share(random), share(random), share(random)));
      const Foot all = brute_force(surface, x), found = surface.nearest(x),
                 started = surface.nearest(x, any(random));
      EXPECT_EQ(found.face, all.face) << name;
      EXPECT_EQ(found.at.distance2, all.at.distance2) << name;
      EXPECT_EQ(started.face, all.face) << name;
      EXPECT_EQ(started.at.weights, all.at.weights) << name;
      std::vector<int> faces(static_cast<std::size_t>(mesh.faces.cols()));
      for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<int>(f);
      EXPECT_EQ(surface.is_inside(found), std::abs(mesh::winding_number(mesh, faces, x)) > 0.5)
          << name << " " << x.transpose() << " distance " << std::sqrt(found.at.distance2);
      inside += surface.is_inside(found);
    }
    EXPECT_GT(inside, 10) << name;
    if (body.skin.cluster_count() > 20) {
      EXPECT_LT(surface.count().triangles, surface.count().searches * body.skin.face_count() / 3) << name;
    }
  }
}

// At a needle's tip, a point outside in front of the tip is behind two of the faces that meet there; the
// pseudonormal gives the right side.
TEST(DistanceSurface, SideAtASharpVertexIsThePseudonormals) {
  TriMesh needle;
  needle.vertices.resize(3, 4);
  needle.vertices << 0, 1, 1, 1, 0, 0.1, -0.1, 0, 0, 0.1, 0.1, -0.1;
  needle.faces.resize(3, 4);
  needle.faces << 0, 0, 0, 1, 1, 2, 3, 3, 2, 3, 1, 2;
  if (mesh::enclosed_volume(needle) < 0) needle.faces.row(1).swap(needle.faces.row(2));
  const Body body = shell(needle);
  Surface surface(body.skin);
  surface.move(body.at());
  int behind = 0;
  for (const Vec3& x :
       {Vec3(-0.05, 0.01, 0.0), Vec3(-0.05, 0, 0), Vec3(-0.01, 0, 0.05), Vec3(-0.02, 0.1, 0.05)}) {
    EXPECT_FALSE(surface.is_inside(surface.nearest(x)));
    for (int f = 0; f < 4; ++f) {
      const Vec3 n =
          (surface.corner(f, 1) - surface.corner(f, 0)).cross(surface.corner(f, 2) - surface.corner(f, 0));
      behind += n.dot(x - surface.corner(f, 0)) < 0;
    }
  }
  // In front of each edge, within the wedge of its two normals and near one of them.
  for (int f = 0; f < 4; ++f)
    for (int k = 0; k < 3; ++k) {
      const auto normal = [&](int face) {
        return Vec3((surface.corner(face, 1) - surface.corner(face, 0))
                        .cross(surface.corner(face, 2) - surface.corner(face, 0))
                        .normalized());
      };
      const Vec3 y = 0.5 * (surface.corner(f, (k + 1) % 3) + surface.corner(f, (k + 2) % 3));
      const Foot foot = surface.nearest(y + 0.01 * (0.9 * normal(f) + 0.1 * normal(body.skin.across(k, f))));
      EXPECT_EQ((foot.at.weights.array() == 0.0).count(), 1);
      EXPECT_FALSE(surface.is_inside(foot));
    }
  EXPECT_GT(behind, 2);  // a single face's normal would have given inside
  EXPECT_TRUE(surface.is_inside(surface.nearest(Vec3(0.8, 0.0, 0.02))));
}
