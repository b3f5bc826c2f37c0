// The quadrature's points against integrals of polynomials over triangles.
#include "bodies.h"

using namespace distance_tests;

namespace {

/// Integral of a quadratic over the skin by the midpoints of edges, which is exact on each triangle.
template <class Function>
double exact(const Skin& skin, const Points& x, const Function& f) {
  double sum = 0.0;
  for (int face = 0; face < skin.face_count(); ++face)
    for (int k = 0; k < 3; ++k)
      sum += skin.area[face] / 3 *
             f(Vec3(0.5 * (x.col(skin.faces(k, face)) + x.col(skin.faces((k + 1) % 3, face)))));
  return sum;
}

}  // namespace

// Cut to equal parts or to parts that differ from face to face.
TEST(ContactPoints, IntegrateQuadraticsAndTheCoarseRuleLinearOnes) {
  const TriMesh mesh = bumpy_sphere(1.0, 4, 0.2);
  const Skin skin = make_skin(mesh);
  const auto quadratic = [](const Vec3& x) { return x.x() * x.x() + 0.3 * x.y() * x.z() - x.z() + 0.7; };
  const auto linear = [](const Vec3& x) { return x.x() - 2 * x.y() + 0.5 * x.z() + 1; };
  for (const double spacing : {HUGE_VAL, 0.9 * skin.longest_edge.mean(), 0.3 * skin.longest_edge.mean()}) {
    const auto points = contact_points(skin, spacing);
    double fine = 0.0, fine_linear = 0.0, coarse = 0.0, coarse_quadratic = 0.0;
    for (const ContactPoint& p : points) {
      EXPECT_GT(p.area, 0.0);
      EXPECT_NEAR(p.weights.sum(), 1.0, 1e-15);
      Vec3 x = Vec3::Zero();
      for (int k = 0; k < 3; ++k) x += p.weights[k] * mesh.vertices.col(skin.faces(k, p.face));
      fine += p.area * quadratic(x);
      fine_linear += p.area * linear(x);
      coarse += p.coarse * linear(x);
      coarse_quadratic += p.coarse * quadratic(x);
    }
    EXPECT_NEAR(fine, exact(skin, mesh.vertices, quadratic), 1e-12);
    EXPECT_NEAR(fine_linear, exact(skin, mesh.vertices, linear), 1e-12);
    EXPECT_NEAR(coarse, exact(skin, mesh.vertices, linear), 1e-12);
    EXPECT_GT(std::abs(coarse_quadratic - fine), 1e-5);  // of lower degree, so that they can be compared
  }
}

// Euler: 3/2 points per triangle, and the two that a sphere has more.
TEST(ContactPoints, AreSharedByFacesThatAreCutAlike) {
  const Skin skin = make_skin(mesh::sphere(1.0, 1));
  ASSERT_LT(skin.longest_edge.maxCoeff() / skin.longest_edge.minCoeff(), 1.0 + 1e-12);
  for (const int n : {1, 2, 3, 16}) {
    EXPECT_EQ(static_cast<int>(contact_points(skin, skin.longest_edge[0] / n).size()),
              skin.face_count() * n * n * 3 / 2 + 2);
  }
}

TEST(ContactPoints, StandNoFartherApartThanAsked) {
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

TEST(ContactPoints, AreOrderedByFace) {
  const auto points = contact_points(make_skin(mesh::sphere(1.0, 3)), 0.3);
  for (std::size_t i = 1; i < points.size(); ++i) EXPECT_LE(points[i - 1].face, points[i].face);
}

TEST(ContactPoints, RejectASpacingThatIsNone) {
  const Skin skin = make_skin(mesh::sphere(1.0, 2));
  expect_message([&] { contact_points(skin, 0.0); }, {"a spacing of 0 m"});
  expect_message([&] { contact_points(skin, std::nan("")); }, {"it must be positive"});
}
