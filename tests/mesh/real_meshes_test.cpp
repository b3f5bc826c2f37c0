#include <cmath>
#include <cstdlib>
#include <numbers>

#include "helpers.h"
#include "mesh/surface_checks.h"
#include "palpate/mesh/boundary.h"

using namespace palpate;
using namespace palpate::mesh;

// Meshes by third parties, found through PALPATE_TEST_DATA; the expected counts are those of the files'
// headers.
namespace {

class RealMeshes : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("PALPATE_TEST_DATA");
    if (folder == nullptr) GTEST_SKIP() << "PALPATE_TEST_DATA is not set: real meshes are not tested";
    folder_ = folder;
  }
  void expect_counts(const std::string& name, int nodes, int elements, int flipped = 0) {
    const MeshReport r = read_any(folder_, name);
    EXPECT_EQ(r.nodes, nodes) << name;
    EXPECT_EQ(r.elements, elements) << name;
    EXPECT_EQ(r.flipped, flipped) << name;
    EXPECT_GT(r.volume, 0) << name;
  }
  std::string folder_;
};

}  // namespace

TEST_F(RealMeshes, GmshTetrahedraHaveTheirCounts) {
  expect_counts("sphere1K.msh", 1760, 6851);
  expect_counts("bar-2523.msh", 886, 2523);
  expect_counts("dolphin5K.msh", 8111, 36304);
}

TEST_F(RealMeshes, BoundariesAreClosedAndEncloseTheVolume) {
  for (const char* name : {"sphere1K.msh", "bar-2523.msh", "dolphin5K.msh"}) {
    MeshReport r;
    TriMesh skin = boundary(tet_mesh(file_spec(name), folder_, &r)).surface;
    EXPECT_EQ(check_surface(skin, surface_provenance(name)).flipped, 0) << name;
    EXPECT_NEAR(enclosed_volume(skin), r.volume, 1e-12 * r.volume) << name;
  }
}

TEST_F(RealMeshes, SphereAndBarHaveTheVolumeOfTheirShape) {
  MeshReport r;
  const TetMesh ball = tet_mesh(file_spec("sphere1K.msh"), folder_, &r);
  const double radius = 0.5 * (ball.nodes.rowwise().maxCoeff() - ball.nodes.rowwise().minCoeff()).mean();
  const double exact = 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
  EXPECT_LT(r.volume, exact);
  EXPECT_GT(r.volume, 0.97 * exact);
  const TetMesh bar = tet_mesh(file_spec("bar-2523.msh"), folder_, &r);
  const Vec3 size = bar.nodes.rowwise().maxCoeff() - bar.nodes.rowwise().minCoeff();
  EXPECT_NEAR(r.volume, size.prod(), 1e-6 * size.prod());
}

// Its sixth element has volume -4.5 and is reordered. All six are numbered 44, which is ignored. The sum of
// |V| was computed by hand.
TEST_F(RealMeshes, BadSixTetsAreMended) {
  MeshReport r;
  tet_mesh(file_spec("bad-6-tets.msh"), folder_, &r);
  EXPECT_EQ(r.elements, 6);
  EXPECT_EQ(r.flipped, 1);
  EXPECT_NEAR(r.volume, 9 + 0.75 + 21 + 4.5 + 0.9 + 4.5, 1e-13);
}

TEST_F(RealMeshes, GmshOneIsRefusedWithTheConversion) {
  const std::string message = error_of([&] { tet_mesh(file_spec("liver2.msh"), folder_); });
  expect_contains(message, "liver2.msh:1: this is Gmsh format 1 ($NOD)");
  expect_contains(message, "gmsh ");
}

TEST_F(RealMeshes, SurfacesAreClosedWithTheirCounts) {
  expect_counts("spot.obj", 2930, 5856);
  expect_counts("femur.obj", 4900, 9796);
  expect_counts("patella.obj", 1623, 3242);
  expect_counts("liver-smooth.obj", 2194, 4384);
}
