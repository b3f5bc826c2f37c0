#include "mesh/surface_checks.h"
#include "mesh/tet_checks.h"

#include <limits>

#include "helpers.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "palpate/mesh/quality.h"

using namespace palpate;
using namespace palpate::mesh;

namespace {

const Provenance kHere = [] {
  Provenance p;
  p.source = "here";
  return p;
}();

std::string refusal(TetMesh mesh) {
  return error_of([&] { check_tets(mesh, kHere); });
}
std::string refusal(TriMesh mesh) {
  return error_of([&] { check_surface(mesh, surface_provenance("here")); });
}

TriMesh cube_surface(double size, const Vec3& centre) {
  TriMesh mesh = box_surface(Vec3::Constant(size), {1, 1, 1});
  mesh.vertices.colwise() += centre;
  return mesh;
}

TriMesh both(const TriMesh& a, const TriMesh& b) {
  TriMesh out;
  out.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  out.vertices << a.vertices, b.vertices;
  out.faces.resize(3, a.faces.cols() + b.faces.cols());
  out.faces << a.faces, (b.faces.array() + static_cast<int>(a.vertices.cols())).matrix();
  return out;
}

void flip(Faces& faces, int f) { std::swap(faces(0, f), faces(1, f)); }

}  // namespace

TEST(TetChecks, MendOrientationAndCountIt) {
  const TetMesh good = box({1, 1, 1}, {2, 2, 2});
  TetMesh mesh = good;
  for (const int t : {0, 7, 39}) std::swap(mesh.tets(0, t), mesh.tets(1, t));
  const MeshReport r = check_tets(mesh, kHere);
  EXPECT_EQ(r.flipped, 3);
  EXPECT_NEAR(r.volume, 1.0, 1e-15);
  for (int t = 0; t < static_cast<int>(mesh.tets.cols()); ++t) EXPECT_GT(tet_volume(mesh, t), 0);
  EXPECT_EQ(check_tets(mesh, kHere).flipped, 0);
}

TEST(TetChecks, RefuseWhatNoSimulationCanUse) {
  const TetMesh good = corner_tet({1, 1, 1});
  EXPECT_EQ(refusal(good), "nothing was refused");
  expect_contains(refusal(TetMesh{}), "here: the mesh has no tetrahedra");

  TetMesh bad = good;
  bad.nodes(1, 2) = std::numeric_limits<double>::infinity();
  expect_contains(refusal(bad), "here: node 2: y = inf is not a finite length");

  bad = good;
  bad.nodes.col(3) = Vec3(0.3, 0.3, 0);
  expect_contains(refusal(bad), "here: element 0 is degenerate: volume = 0 m^3 with edges up to 1.41 m");

  bad = good;
  bad.nodes.conservativeResize(3, 5);
  bad.nodes.col(4) = Vec3(1, 1, 1);
  expect_contains(refusal(bad), "here: node 4 (one of 1) belongs to no tetrahedron");
}

// 6 sqrt 2 V / edge^3 with V = lift/3 and edge = 2 for the square sliver of helpers: 2.1 lift for a square
// with diagonal 2 and half-height lift.
TEST(TetChecks, KeepSliversAndRefuseOnlyWhatRoundingCannotTell) {
  const auto sliver = [](double lift, double offset) {
    TetMesh mesh = corner_tet({1, 1, 1});
    mesh.nodes << 1, -1, 0, 0, 0, 0, 1, -1, lift, lift, -lift, -lift;
    mesh.nodes.array() += offset;
    return mesh;
  };
  EXPECT_EQ(refusal(sliver(1e-3, 0)), "nothing was refused");  // dihedral angles of 0.16 degree
  EXPECT_EQ(refusal(sliver(1e-8, 0)), "nothing was refused");
  expect_contains(refusal(sliver(1e-10, 0)), "is degenerate");
  expect_contains(refusal(sliver(1e-8, 1e9)), "is degenerate");  // coordinates there are spaced by 1e-7
  EXPECT_EQ(refusal(sliver(1e-3, 1e3)), "nothing was refused");
}

TEST(SurfaceChecks, MendOneFaceAllFacesAndNone) {
  const TriMesh good = cube_surface(2, {5, 0, 0});
  TriMesh one = good, all = good;
  flip(one.faces, 4);
  for (int f = 0; f < 12; ++f) flip(all.faces, f);
  TriMesh same = good;
  EXPECT_EQ(check_surface(same, surface_provenance("here")).flipped, 0);
  EXPECT_EQ(same.faces, good.faces);
  EXPECT_EQ(check_surface(one, surface_provenance("here")).flipped, 1);
  EXPECT_EQ(check_surface(all, surface_provenance("here")).flipped, 12);
  for (const TriMesh& mesh : {one, all}) EXPECT_NEAR(enclosed_volume(mesh), 8.0, 1e-14);
}

TEST(SurfaceChecks, ShellsSideBySideAddAndNestedOnesAlternate) {
  TriMesh apart = both(cube_surface(1, {0, 0, 0}), cube_surface(2, {9, 0, 0}));
  flip(apart.faces, 0);
  EXPECT_NEAR(check_surface(apart, surface_provenance("here")).volume, 9.0, 1e-13);

  TriMesh cavity = both(cube_surface(1, {0.1, 0, 0}), cube_surface(3, {0, 0, 0}));
  const MeshReport r = check_surface(cavity, surface_provenance("here"));
  EXPECT_EQ(r.flipped, 12);
  EXPECT_NEAR(r.volume, 26.0, 1e-13);

  TriMesh onion = both(cavity, cube_surface(0.5, {0.1, 0, 0}));  // a solid body inside the cavity
  EXPECT_NEAR(check_surface(onion, surface_provenance("here")).volume, 26.125, 1e-13);
}

TEST(SurfaceChecks, RefuseOpenCrowdedDegenerateDuplicateAndUnreferenced) {
  const TriMesh good = cube_surface(1, {0, 0, 0});
  TriMesh bad = good;
  bad.faces = Faces(good.faces.leftCols(11));
  expect_contains(refusal(bad), "belongs to no other face: the surface is not closed there");

  bad = good;
  bad.vertices.col(bad.faces(0, 0)) =
      0.5 * (bad.vertices.col(bad.faces(1, 0)) + bad.vertices.col(bad.faces(2, 0)));
  expect_contains(refusal(bad), "here: face 0 is degenerate: area = 0 m^2");

  bad = both(good, good);
  bad.faces.col(12) = bad.faces.col(0);
  expect_contains(refusal(bad), "has the same corners as");

  bad = good;
  bad.vertices(2, 1) = std::numeric_limits<double>::quiet_NaN();
  expect_contains(refusal(bad), "here: vertex 1: z = nan");

  expect_contains(refusal(TriMesh{}), "the surface has no faces");
}

TEST(SurfaceChecks, RefuseAShellWithoutVolume) {
  TriMesh flat = box_surface({1, 1, 1}, {3, 3, 1});
  // flattened, with the vertical sides folded outwards
  for (Eigen::Index v = 0; v < flat.vertices.cols(); ++v) {
    flat.vertices.col(v).head<2>() *= flat.vertices(2, v) > 0 ? 1.0 : 1.3;
    flat.vertices(2, v) = 0;
  }
  expect_contains(refusal(flat), "encloses no volume");
}
