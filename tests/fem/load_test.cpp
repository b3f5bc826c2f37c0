#include "palpate/fem/load.h"

#include "fem_fixture.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

TEST(Load, GravityIsTheWeightAndItsPotential) {
  const TetMesh mesh = jittered_cube(2, 0.1, 51);
  const VecX masses = lumped_masses(mesh, 700.0);
  OneBody at(flat(mesh.nodes), VecX::Zero(3 * mesh.nodes.cols()));
  const auto gravity = make_gravity(masses, {0, 0, -9.81}, at.id);
  VecX f = VecX::Zero(3 * mesh.nodes.cols());
  gravity->add_force(at.state.view(), f);
  EXPECT_LT((unflat(f).rowwise().sum() - Vec3(0, 0, -9.81 * masses.sum())).norm(), 1e-10);
  const double expected = 9.81 * masses.dot(VecX(mesh.nodes.row(2).transpose()));
  EXPECT_NEAR(gravity->energy(at.state.view()), expected, 1e-12 * expected);
  EXPECT_TRUE(gravity->traits().conservative);
  EXPECT_FALSE(gravity->traits().stiff);
}

TEST(Load, DeadLoadIsMinusTheGradientOfItsEnergy) {
  const TetMesh mesh = one_tet();
  const Points forces = unflat(Random(52).vector(12));
  const VecX x = flat(mesh.nodes), w = Random(53).vector(12);
  OneBody here(x, VecX::Zero(12)), there(x + w, VecX::Zero(12));
  const auto load = make_dead_load("pull", forces, 0);
  EXPECT_EQ(load->name(), "pull");
  EXPECT_NEAR(load->energy(there.state.view()) - load->energy(here.state.view()), -flat(forces).dot(w),
              1e-14);
}

TEST(Load, TractionIsSharedByBoundaryArea) {
  // The face x = 1 of the unit cube: resultant F, with the moment of F at the centre of the face.
  const TetMesh mesh = jittered_cube(3, 0.0, 54);
  LoadSpec spec;
  spec.box_min_m = Vec3(0.999, -1, -1);
  spec.box_max_m = Vec3(1.001, 2, 2);
  spec.force_n = Vec3(1, -2, 3);
  const Points f = spread_over_boundary(mesh, spec);
  EXPECT_LT((f.rowwise().sum() - spec.force_n).norm(), 1e-14);
  Vec3 moment = Vec3::Zero();
  int loaded = 0;
  for (Eigen::Index i = 0; i < f.cols(); ++i) {
    moment += mesh.nodes.col(i).cross(f.col(i));
    if (f.col(i).norm() > 0.0) ++loaded;
  }
  EXPECT_EQ(loaded, 16);
  EXPECT_LT((moment - Vec3(1, 0.5, 0.5).cross(spec.force_n)).norm(), 1e-14);
}

TEST(Load, RefusesEmptyBoxesAndBadNumbers) {
  const TetMesh mesh = jittered_cube(1, 0.0, 55);
  LoadSpec spec;
  spec.force_n = Vec3(0, 0, 1);
  spec.box_min_m = Vec3(5, 5, 5);
  spec.box_max_m = Vec3(6, 6, 6);
  expect_contains(message_of([&] { spread_over_boundary(mesh, spec); }),
                  "load: no boundary triangle of the mesh lies in the box (5, 5, 5) to (6, 6, 6) m");
  spec.box_min_m = Vec3(7, 5, 5);
  expect_contains(message_of([&] { spread_over_boundary(mesh, spec); }),
                  "load: box_min_m[0] = 7 must not exceed box_max_m[0] = 6");
  spec.box_min_m = Vec3::Zero();
  spec.force_n.y() = std::nan("");
  expect_contains(message_of([&] { spread_over_boundary(mesh, spec); }),
                  "force_n = (0, nan, 1) must be finite");
  expect_contains(message_of([] { make_gravity(VecX::Ones(4), Vec3(0, std::nan(""), 0), 0); }),
                  "gravity_m_s2 = (0, nan, 0) must be finite");
  expect_contains(message_of([] { make_dead_load("pull", Points::Constant(3, 4, std::nan("")), 0); }),
                  "load \"pull\": forces must be finite");
}
