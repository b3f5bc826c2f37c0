#include "fem_fixture.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

namespace {

double volume(const TetMesh& mesh) {
  double sum = 0.0;
  for (const auto& tet : mesh.tets.colwise()) {
    Mat3 edges;
    for (int a = 0; a < 3; ++a) edges.col(a) = mesh.nodes.col(tet[a + 1]) - mesh.nodes.col(tet[0]);
    sum += edges.determinant() / 6.0;
  }
  return sum;
}

MatX assembled(const dynamics::InertiaTerm& mass, const OneBody& at, double scale) {
  dynamics::PatternBuilder builder(at.state.layout());
  mass.add_pattern(builder);
  dynamics::BorderedMatrix A;
  A.body = builder.build();
  mass.add_mass(at.state.view(), scale, A);
  return A.to_dense();
}

}  // namespace

TEST(Mass, LumpedSumsToTheBodysMass) {
  const TetMesh mesh = jittered_cube(3, 0.15, 41);
  const VecX masses = lumped_masses(mesh, 1050.0);
  EXPECT_GT(masses.minCoeff(), 0.0);
  EXPECT_NEAR(masses.sum(), 1050.0 * volume(mesh), 1e-10);
}

TEST(Mass, ConsistentRowSumsAreTheLumpedMasses) {
  const TetMesh mesh = jittered_cube(2, 0.15, 42);
  OneBody at(flat(mesh.nodes), VecX::Zero(3 * mesh.nodes.cols()));
  const auto mass = make_consistent_mass(mesh, 3.0, at.id);
  EXPECT_FALSE(mass->diagonal());
  EXPECT_EQ(mass->block_id(), at.id);
  const MatX M = assembled(*mass, at, 1.0);
  EXPECT_EQ((M - M.transpose()).norm(), 0.0);
  const VecX lumped = lumped_masses(mesh, 3.0);
  for (int axis = 0; axis < 3; ++axis) {
    const VecX unit = flat(Vec3::Unit(axis).replicate(1, mesh.nodes.cols()));
    const Points rows = unflat(M * unit);
    EXPECT_LT((rows - Vec3::Unit(axis) * lumped.transpose()).norm(), 1e-14);
  }
}

TEST(Mass, ConsistentEnergyOfALinearFieldIsExact) {
  // 1/2 integral rho |v|^2 over the unit tetrahedron with v = (x, 0, 0): rho/2 * 1/60.
  TetMesh mesh;
  mesh.nodes.resize(3, 4);
  mesh.nodes << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.tets.resize(4, 1);
  mesh.tets << 0, 1, 2, 3;
  VecX v = VecX::Zero(12);
  v[3] = 1.0;
  OneBody at(flat(mesh.nodes), v);
  VecX p = VecX::Zero(12);
  make_consistent_mass(mesh, 2.0, at.id)->apply(at.state.view(), v, p);
  EXPECT_NEAR(0.5 * v.dot(p), 0.5 * 2.0 / 60.0, 1e-16);
}

TEST(Mass, AppliedEqualsAssembled) {
  const TetMesh mesh = jittered_cube(2, 0.1, 43);
  OneBody at(flat(mesh.nodes), VecX::Zero(3 * mesh.nodes.cols()));
  const VecX w = Random(44).vector(3 * mesh.nodes.cols());
  for (const auto& mass : {make_lumped_mass(mesh, 2.5, at.id), make_consistent_mass(mesh, 2.5, at.id)}) {
    VecX y = VecX::Zero(w.size());
    mass->apply(at.state.view(), w, y);
    EXPECT_LT((0.3 * y - assembled(*mass, at, 0.3) * w).norm(), 1e-14);
  }
  EXPECT_TRUE(make_lumped_mass(mesh, 2.5, at.id)->diagonal());
}

TEST(Mass, RefusesABadDensity) {
  expect_contains(message_of([] { lumped_masses(one_tet(), 0.0); }), "density_kg_m3 = 0 must be positive");
  expect_contains(message_of([] { make_consistent_mass(one_tet(), -1.0, 0); }),
                  "density_kg_m3 = -1 must be positive");
}
