#include "model/tetrahedralise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/surface_checks.h"
#include "mesh/tet_checks.h"
#include "model/quality_gate.h"
#include "surfaces.h"

using namespace palpate;
using namespace surfaces;

namespace {

model::TetrahedraOptions number(int tetrahedra) {
  model::TetrahedraOptions out;
  out.tetrahedra = tetrahedra;
  return out;
}

/// Checks that a mesh is valid, with a boundary that is one closed surface.
model::TetQuality sound(TetMesh mesh, double volume) {
  mesh::Provenance from;
  from.source = "test";
  mesh::check_tets(mesh, from);
  TriMesh boundary = mesh::boundary(mesh).surface;
  mesh::check_surface(boundary, from);
  return model::measure_quality(mesh, volume);
}

TEST(Tetrahedralise, MeetsTheNumberAndTheVolumeWithGoodAngles) {
  for (const int requested : {500, 3000}) {
    const model::Tetrahedra made = model::tetrahedralise(ball(1.0, 12), number(requested));
    const model::TetQuality q = sound(made.mesh, volume(ball(1.0, 12)));
    EXPECT_NEAR(q.tetrahedra, requested, 0.03 * requested);
    EXPECT_GE(q.smallest_dihedral_deg, 8.0);
    EXPECT_LE(q.volume_error, 1e-4);  // fitted, rather than inscribed
  }
}

TEST(Tetrahedralise, MeetsTheElementSize) {
  model::TetrahedraOptions options;
  options.element_size_m = 0.25;
  const model::TetQuality q = sound(model::tetrahedralise(ball(), options).mesh, volume(ball()));
  EXPECT_NEAR(q.mean_edge, 0.25, 0.03 * 0.25);
}

TEST(Tetrahedralise, ProgressNeverRunsBack) {
  for (const int requested : {400, 800}) {
    std::vector<double> told;
    model::tetrahedralise(ball(), number(requested), [&](double fraction) { told.push_back(fraction); });
    ASSERT_GT(told.size(), 3u);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_GE(told.front(), 0.0);
    EXPECT_EQ(told.back(), 1.0);
  }
}

TEST(Tetrahedralise, SameSurfaceSameBits) {
  const model::Tetrahedra one = model::tetrahedralise(ball(), number(800)),
                          two = model::tetrahedralise(ball(), number(800));
  EXPECT_EQ(one.mesh.nodes, two.mesh.nodes);
  EXPECT_EQ(one.mesh.tets, two.mesh.tets);
}

TEST(Tetrahedralise, KeepsTheCreasesOfABox) {
  model::TetrahedraOptions options = number(1500);
  options.crease_deg = 50.0;
  const model::Tetrahedra made = model::tetrahedralise(box(), options);
  const model::TetQuality q = sound(made.mesh, 2.0);
  EXPECT_GE(q.smallest_dihedral_deg, model::kSharpDihedralDeg);
  EXPECT_LE(q.volume_error, 1e-9);  // flat sides and kept edges: exact
  // The corners are nodes, and every boundary node lies on a side.
  const mesh::Boundary boundary = mesh::boundary(made.mesh);
  int corners = 0;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-0.5, 0.5})
        for (Eigen::Index i = 0; i < made.mesh.nodes.cols(); ++i)
          corners += (made.mesh.nodes.col(i) - Vec3(x, y, z)).norm() < 1e-9;
  EXPECT_EQ(corners, 8);
  for (Eigen::Index i = 0; i < boundary.surface.vertices.cols(); ++i) {
    const Vec3 p = boundary.surface.vertices.col(i).cwiseAbs();
    EXPECT_LT(std::min({std::abs(p.x() - 1), std::abs(p.y() - 0.5), std::abs(p.z() - 0.5)}), 1e-6);
  }
}

TEST(Tetrahedralise, KeepsGivenLines) {
  model::TetrahedraOptions options = number(800);
  const Vec3 a(-1, -0.5, 0.5), b(1, -0.5, 0.5), c(1, 0.5, 0.5), d(-1, 0.5, 0.5);
  options.creases = {{a, b, c, d, a}};
  const model::Tetrahedra made = model::tetrahedralise(box(), options);
  for (const Vec3& corner : {a, b, c, d}) {
    double nearest = 1;
    for (Eigen::Index i = 0; i < made.mesh.nodes.cols(); ++i)
      nearest = std::min(nearest, (made.mesh.nodes.col(i) - corner).norm());
    EXPECT_LT(nearest, 1e-9);
  }
  EXPECT_LE(sound(made.mesh, 2.0).volume_error, 0.01);
}

TEST(Tetrahedralise, FillsAroundACavity) {
  const TriMesh hollow = together(ball(1.0, 10), turned(ball(0.4, 6)));
  const model::TetQuality q = sound(model::tetrahedralise(hollow, number(4000)).mesh, volume(hollow));
  EXPECT_LE(q.volume_error, 0.005);  // 0.068 without the cavity
  EXPECT_GE(q.smallest_dihedral_deg, 8.0);
}

TEST(Tetrahedralise, FillsAnImplicitBall) {
  const auto inside = [](const Vec3& p) { return p.norm() - 1.0; };
  const model::Tetrahedra made = model::tetrahedralise(inside, Vec3(0.1, 0, 0), 1.3, number(2000));
  const model::TetQuality q = sound(made.mesh, 4 * M_PI / 3);
  EXPECT_NEAR(q.tetrahedra, 2000, 60);
  EXPECT_LE(q.volume_error, 0.005);
  EXPECT_GE(q.smallest_dihedral_deg, 8.0);
}

TEST(Tetrahedralise, RefusesWhatCannotBe) {
  EXPECT_EQ(refusal([] { model::tetrahedralise(ball(), number(3)); }),
            "--tetrahedra 3 must lie in [20, 20000000]");
  model::TetrahedraOptions tiny;
  tiny.element_size_m = 1e-6;
  EXPECT_NE(refusal([&] { model::tetrahedralise(ball(), tiny); }).find("check the unit of length"),
            std::string::npos);
  const auto outside = [](const Vec3& p) { return p.norm() + 1.0; };
  EXPECT_EQ(refusal([&] { model::tetrahedralise(outside, Vec3::Zero(), 1.0, number(100)); }),
            "the implicit function is 1 at the centre (0, 0, 0) m, must be negative inside");
}

/// The time of previous steps counts, and the message states the total: the user's limit.
TEST(Tetrahedralise, NamesTheWholeTimeWhenItIsOver) {
  model::TetrahedraOptions late = number(3'000'000);
  late.limits.seconds = 60.0;
  late.limits.spent = 59.5;
  const std::string said = refusal([&] { model::tetrahedralise(ball(), late); });
  EXPECT_NE(said.find("within 60 s"), std::string::npos) << said;
}

}  // namespace
