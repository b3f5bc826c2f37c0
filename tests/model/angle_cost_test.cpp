#include "model/angle_cost.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "palpate/mesh/generators.h"

using namespace palpate;
using model::AngleCost;

namespace {

constexpr double kMu = AngleCost::kYoungsModulus / (2 * (1 + AngleCost::kPoissonsRatio)),
                 kLambda = AngleCost::kYoungsModulus * AngleCost::kPoissonsRatio /
                           ((1 + AngleCost::kPoissonsRatio) * (1 - 2 * AngleCost::kPoissonsRatio));

// The regular tetrahedron with corners at (1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1): g_a = x_a / 4, so
// that a displacement u_a = F x_a has the gradient F and the nodal forces V P g_a = V P x_a / 4. With the
// nodal mass rho V / 4, P = 2 mu F for a symmetric F without trace, and P = (3 lambda + 2 mu) F for F = I:
// the eigenvalues are 2 mu / rho and (3 lambda + 2 mu) / rho.
TEST(AngleCost, RegularTetrahedronByHand) {
  TetMesh mesh;
  mesh.nodes = (Points(3, 4) << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1).finished();
  mesh.tets = (Tets(4, 1) << 0, 1, 3, 2).finished();
  const Vec3 a = mesh.nodes.col(0), b = mesh.nodes.col(mesh.tets(1, 0)), c = mesh.nodes.col(mesh.tets(2, 0)),
             d = mesh.nodes.col(mesh.tets(3, 0));
  if ((b - a).cross(c - a).dot(d - a) < 0) mesh.tets.col(0) << 0, 1, 2, 3;
  const double exact = (3 * kLambda + 2 * kMu) / AngleCost::kDensity;
  EXPECT_NEAR(model::largest_eigenvalue(mesh), exact, 1e-9 * exact);
}

TEST(AngleCost, ScalesWithTheSizeAndGrowsWithFlatness) {
  const TetMesh mesh = mesh::ball(1.0, 0.4);
  TetMesh large = mesh, flat = mesh;
  large.nodes *= 10;
  // K scales with the size, M with its cube.
  EXPECT_NEAR(model::largest_eigenvalue(large) * 100, model::largest_eigenvalue(mesh),
              1e-6 * model::largest_eigenvalue(mesh));
  flat.nodes.row(2) *= 0.01;
  const AngleCost cost = model::price_of_angles(flat, 8.0);
  EXPECT_GT(cost.bad, 0);
  EXPECT_EQ(cost.all, mesh.tets.cols());
  EXPECT_GT(cost.good_explicit_step_s, 5 * cost.explicit_step_s);
  EXPECT_GT(cost.condition, cost.good_condition);
  EXPECT_NEAR(cost.condition, 1 + 4 * std::pow(AngleCost::kImplicitStep / cost.explicit_step_s, 2),
              1e-9 * cost.condition);
}

TEST(AngleCost, OfTheGoodMeshItselfIsNothing) {
  const AngleCost cost = model::price_of_angles(mesh::box(Vec3::Constant(1.6), {8, 8, 8}), 8.0);
  EXPECT_EQ(cost.bad, 0);
  EXPECT_NEAR(cost.explicit_step_s, cost.good_explicit_step_s, 1e-6 * cost.good_explicit_step_s);
}

}  // namespace
