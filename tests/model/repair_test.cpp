#include "model/repair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "surfaces.h"

using namespace palpate;
using namespace surfaces;

namespace {

bool noted(const model::RepairedSurface& result, const std::string& words) {
  for (const std::string& note : result.notes)
    if (note.find(words) != std::string::npos) return true;
  return false;
}

TEST(Repair, LeavesASoundSurfaceAlone) {
  const model::RepairedSurface result = repaired(ball());
  EXPECT_TRUE(result.notes.empty()) << result.notes[0];
  EXPECT_EQ(result.surface.vertices, ball().vertices);
  EXPECT_EQ(result.surface.faces.cols(), ball().faces.cols());
  EXPECT_NEAR(volume(result.surface), volume(ball()), 1e-12);
}

TEST(Repair, JoinsLooseTriangles) {
  const model::RepairedSurface result = repaired(loose(ball()));
  EXPECT_EQ(result.surface.vertices.cols(), ball().vertices.cols());
  EXPECT_NEAR(volume(result.surface), volume(ball()), 1e-12);
  EXPECT_TRUE(noted(result, "merged"));
}

TEST(Repair, JoinsSeamsThatRoundingLeftOpen) {
  TriMesh mesh = loose(ball());
  for (Eigen::Index i = 0; i < mesh.vertices.size(); ++i)
    mesh.vertices.data()[i] =
        static_cast<float>(mesh.vertices.data()[i]) * (1 + 1e-7 * std::sin(static_cast<double>(i)));
  const model::RepairedSurface result = repaired(mesh);
  EXPECT_EQ(result.surface.vertices.cols(), ball().vertices.cols());
  EXPECT_TRUE(noted(result, "seams"));
}

TEST(Repair, TurnsFlippedFaces) {
  TriMesh mesh = ball();
  int planted = 0;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); f += 7, ++planted)
    std::swap(mesh.faces(1, f), mesh.faces(2, f));
  const model::RepairedSurface result = repaired(mesh);
  EXPECT_NEAR(volume(result.surface), volume(ball()), 1e-12);
  EXPECT_TRUE(noted(result, std::to_string(planted) + " faces were reoriented")) << result.notes.size();
}

TEST(Repair, TurnsAnInsideOutSurfaceOutwards) {
  const model::RepairedSurface result = repaired(turned(ball()));
  EXPECT_NEAR(volume(result.surface), volume(ball()), 1e-12);
  EXPECT_TRUE(noted(result, "reoriented outwards"));
}

TEST(Repair, DropsDoubleFacesAndCollapsedOnes) {
  TriMesh mesh = ball();
  const Eigen::Index n = mesh.faces.cols();
  mesh.faces.conservativeResize(3, n + 3);
  mesh.faces.col(n) = mesh.faces.col(5);
  mesh.faces.col(n + 1) << mesh.faces(1, 9), mesh.faces(0, 9), mesh.faces(2, 9);
  mesh.faces.col(n + 2) << 4, 4, 7;
  const model::RepairedSurface result = repaired(mesh);
  EXPECT_EQ(result.surface.faces.cols(), n);
  EXPECT_TRUE(noted(result, "2 duplicate faces"));
  EXPECT_TRUE(noted(result, "1 collapsed faces"));
}

TEST(Repair, ClosesASmallHoleByASmoothPatch) {
  const TriMesh open = without(ball(), [](const Vec3& p) { return p.z() > 0.95; });
  ASSERT_LT(open.faces.cols(), ball().faces.cols());
  const model::RepairedSurface result = repaired(open);
  EXPECT_TRUE(noted(result, "1 holes were closed"));
  // The removed cap has a volume of pi h^2 (3 - h) / 3 = 0.0077; a flat lid loses it, a smooth patch hardly
  // any.
  EXPECT_NEAR(volume(result.surface), volume(ball()), 0.004);
}

TEST(Repair, RefusesTooLargeAHoleWithItsPlace) {
  const TriMesh half = without(ball(), [](const Vec3& p) { return p.z() > 0; });
  const std::string message = refusal([&] { repaired(half); });
  EXPECT_NE(message.find("the surface has a hole of "), std::string::npos) << message;
  EXPECT_NE(message.find("m across"), std::string::npos) << message;
  EXPECT_NE(message.find("test.obj: vertex "), std::string::npos) << message;
}

TEST(Repair, RefusesASheet) {
  const TriMesh sheet = without(box(), [](const Vec3& p) { return p.z() < 0.49; });
  EXPECT_NE(refusal([&] { repaired(sheet); }), "accepted");
}

TEST(Repair, RefusesNumbersThatAreNotFinite) {
  TriMesh mesh = ball();
  mesh.vertices(1, 17) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([&] { repaired(mesh); }),
            "test.obj: vertex 17: y = nan is not a finite length within 1e30 m; write the surface again");
}

TEST(Repair, RefusesASurfaceWithoutAnInside) {
  TriMesh flat = ball();
  flat.vertices.row(2).setZero();
  EXPECT_NE(refusal([&] { repaired(flat); }), "accepted");
  EXPECT_NE(refusal([&] { repaired(TriMesh{}); }), "accepted");
}

TEST(Repair, DropsAnInnerShellThatTurnsOutwards) {
  const model::RepairedSurface result = repaired(together(ball(), ball(0.4, 5)));
  EXPECT_NEAR(volume(result.surface), volume(ball()), 1e-12);
  EXPECT_TRUE(noted(result, "the body is solid there"));
}

TEST(Repair, KeepsACavity) {
  const model::RepairedSurface result = repaired(together(ball(), turned(ball(0.4, 5))));
  EXPECT_NEAR(volume(result.surface), volume(ball()) - volume(ball(0.4, 5)), 1e-12);
  EXPECT_TRUE(noted(result, "cavities"));
}

// A shell in a cavity is a separate body, which the model cannot have.
TEST(Repair, DropsAnIslandInACavity) {
  const model::RepairedSurface result =
      repaired(together(together(ball(), turned(ball(0.4, 5))), ball(0.2, 5)));
  EXPECT_NEAR(volume(result.surface), volume(ball()) - volume(ball(0.4, 5)), 1e-12);
  EXPECT_TRUE(noted(result, "1 shells in cavities were removed"));
  EXPECT_FALSE(noted(result, "solid there"));
}

TEST(Repair, RefusesTwoBodiesUnlessTheLargestIsWanted) {
  const TriMesh two = together(ball(0.5, 5, Vec3(3, 0, 0)), ball());
  const std::string message = refusal([&] { repaired(two); });
  EXPECT_NE(message.find("2 separate bodies"), std::string::npos) << message;
  EXPECT_NE(message.find("face 500"), std::string::npos) << "the first face of the larger one: " << message;
  model::RepairOptions options;
  options.largest_shell = true;
  EXPECT_NEAR(volume(repaired(two, options).surface), volume(ball()), 1e-12);
}

TEST(Repair, DropsSpecks) {
  const model::RepairedSurface result = repaired(together(ball(), ball(0.01, 2, Vec3(2, 0, 0))));
  EXPECT_NEAR(volume(result.surface), volume(ball()), 1e-12);
  EXPECT_TRUE(noted(result, "1 shells smaller"));
}

TEST(Repair, CutsOutAFold) {
  TriMesh mesh = ball(1.0, 12);
  Eigen::Index top = 0;
  mesh.vertices.row(2).maxCoeff(&top);
  mesh.vertices.col(top) = Vec3(0.12, 0.05, -1.3);  // pulled through the opposite side
  const model::RepairedSurface result = repaired(mesh);
  EXPECT_FALSE(result.notes.empty());
  EXPECT_NEAR(volume(result.surface), volume(ball(1.0, 12)), 0.05 * volume(ball(1.0, 12)));
}

TEST(Repair, WrapsOverlappingShellsAndSaysSo) {
  const TriMesh two = together(ball(1.0, 8), ball(1.0, 8, Vec3(1, 0.02, 0.03)));
  const model::RepairedSurface result = repaired(two);
  EXPECT_TRUE(noted(result, "wrapped"));
  // Union of two unit balls whose centres are d apart: 8/3 pi - pi (4 + d) (2 - d)^2 / 12.
  const double d = Vec3(1, 0.02, 0.03).norm(), exact = M_PI * (8.0 / 3 - (4 + d) * (2 - d) * (2 - d) / 12);
  EXPECT_NEAR(volume(result.surface), exact, 0.03 * exact);
  model::RepairOptions strict;
  strict.wrap = false;
  const std::string message = refusal([&] { repaired(two, strict); });
  EXPECT_NE(message.find("others intersect"), std::string::npos) << message;
  EXPECT_NE(message.find("test.obj: face "), std::string::npos) << message;
}

}  // namespace
