// Triangles between contact points: they are the skin, subdivided, and connected.
#include "distance/points.h"
#include "bodies.h"

using namespace distance_tests;

namespace {

Vec3 place(const TriMesh& mesh, const Skin& skin, const ContactPoint& point) {
  Vec3 x = Vec3::Zero();
  for (int k = 0; k < 3; ++k) x += point.weights[k] * mesh.vertices.col(skin.faces(k, point.face));
  return x;
}

}  // namespace

// Each triangle has its stored area and the orientation of its face; the area of a hat function is a third of
// its triangles' area.
TEST(ContactMesh, CutsTheSkin) {
  const TriMesh mesh = bumpy_sphere(1.0, 4, 0.2);
  const Skin skin = make_skin(mesh);
  for (const double spacing : {HUGE_VAL, 0.9 * skin.longest_edge.mean(), 0.3 * skin.longest_edge.mean()}) {
    const ContactMesh cut = contact_mesh(skin, spacing);
    double hats = 0.0, volume = 0.0, whole = 0.0;
    for (const ContactPoint& p : cut.points) {
      EXPECT_NEAR(p.weights.sum(), 1.0, 1e-15);
      EXPECT_GE(p.weights.minCoeff(), 0.0);
      hats += p.area;
    }
    EXPECT_NEAR(hats, skin.area.sum(), 1e-12);
    for (const ContactTriangle& t : cut.triangles) {
      Vec3 x[3];
      for (std::size_t k = 0; k < 3; ++k)
        x[k] = place(mesh, skin, cut.points[static_cast<std::size_t>(t.points[k])]);
      EXPECT_NEAR(0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm(), t.area, 1e-14);
      volume += x[0].dot(x[1].cross(x[2])) / 6.0;
    }
    for (int f = 0; f < skin.face_count(); ++f)
      whole += mesh.vertices.col(skin.faces(0, f))
                   .dot(Vec3(mesh.vertices.col(skin.faces(1, f)))
                            .cross(Vec3(mesh.vertices.col(skin.faces(2, f))))) /
               6.0;
    EXPECT_NEAR(volume, whole, 1e-12);
  }
}

// Euler's formula: half a point per triangle, plus two for a sphere.
TEST(ContactMesh, SharesPointsBetweenFacesThatAreCutAlike) {
  const Skin skin = make_skin(mesh::sphere(1.0, 1));
  ASSERT_LT(skin.longest_edge.maxCoeff() / skin.longest_edge.minCoeff(), 1.0 + 1e-12);
  for (const int n : {1, 2, 3, 16}) {
    const ContactMesh cut = contact_mesh(skin, skin.longest_edge[0] / n);
    EXPECT_EQ(static_cast<int>(cut.triangles.size()), skin.face_count() * n * n);
    EXPECT_EQ(static_cast<int>(cut.points.size()), skin.face_count() * n * n / 2 + 2);
  }
}

TEST(ContactMesh, KnowsTheTrianglesAroundAPoint) {
  const ContactMesh cut = contact_mesh(make_skin(bumpy_sphere(1.0, 3, 0.2)), 0.2);
  std::size_t count = 0;
  for (std::size_t p = 0; p < cut.points.size(); ++p)
    for (int i = cut.fan_begin[p]; i < cut.fan_begin[p + 1]; ++i, ++count) {
      const auto& corners =
          cut.triangles[static_cast<std::size_t>(cut.fan[static_cast<std::size_t>(i)])].points;
      EXPECT_EQ(std::count(corners.begin(), corners.end(), static_cast<int>(p)), 1);
    }
  EXPECT_EQ(count, 3 * cut.triangles.size());
}

TEST(ContactMesh, StandsNoFartherApartThanAsked) {
  const Skin skin = make_skin(bumpy_sphere(1.0, 4, 0.2));
  const double spacing = 0.4 * skin.longest_edge.mean();
  int least = kMostCuts, most = 1;
  for (int face = 0; face < skin.face_count(); ++face) {
    const int n = cuts_of(skin, face, spacing);
    EXPECT_LE(skin.longest_edge[face] / n, spacing * (1.0 + 1e-8));
    EXPECT_TRUE(n == 1 || skin.longest_edge[face] / (n - 1) > spacing) << n;
    least = std::min(least, n);
    most = std::max(most, n);
  }
  EXPECT_LT(least, most) << "faces of one size test nothing";
  EXPECT_EQ(cuts_of(skin, 0, 1e-9), kMostCuts);
}

TEST(ContactMesh, IsOrderedByFace) {
  const ContactMesh cut = contact_mesh(make_skin(mesh::sphere(1.0, 3)), 0.3);
  for (std::size_t i = 1; i < cut.points.size(); ++i) EXPECT_LE(cut.points[i - 1].face, cut.points[i].face);
}

TEST(ContactMesh, RejectsASpacingThatIsNone) {
  const Skin skin = make_skin(mesh::sphere(1.0, 2));
  expect_message([&] { contact_mesh(skin, 0.0); }, {"spacing = 0 m"});
  expect_message([&] { contact_mesh(skin, std::nan("")); }, {"must be positive"});
}
