#include "../../src/fem/corotational.h"
#include "../../src/fem/objective_damping.h"

#include <Eigen/Eigenvalues>

#include "core/polar.h"
#include "fem_fixture.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;
using Mat9 = Eigen::Matrix<double, 9, 9>;

namespace {

const Lame kLame{1.1, 2.3};
const Lame kDamping{0.7, 0.4};

Mat3 rotation_of(const Mat3& F) { return polar_decomposition(F).R; }
VecX vec(const Mat3& m) { return m.reshaped(); }

/// dP/dF as a 9 x 9 matrix, one column per unit direction.
Mat9 hessian(const Mat3& F, Tangent tangent, bool* was_clamped = nullptr) {
  const Mat3 R = rotation_of(F);
  bool clamped = false;
  const Mat3 C = rotation_coupling(tangent, F, R, kLame, clamped);
  if (was_clamped) *was_clamped = clamped;
  Mat9 H;
  for (int i = 0; i < 9; ++i) {
    Mat3 dF = Mat3::Zero();
    dF(i % 3, i / 3) = 1.0;
    H.col(i) = elastic_stress_change(dF, R, C, kLame).reshaped();
  }
  return H;
}

/// Nearest positive semi-definite matrix, by numerical eigenvalues.
Mat9 numeric_projection(const Mat9& H) {
  const Eigen::SelfAdjointEigenSolver<Mat9> eigen(0.5 * (H + H.transpose()));
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace

TEST(Corotated, StressIsTheDerivativeOfTheEnergy) {
  Random random(1);
  for (const auto& [name, stretches] : stretch_cases()) {
    const Mat3 F = deformation(random, stretches), dF = random.matrix();
    const double derivative = elastic_stress(F, rotation_of(F), kLame).cwiseProduct(dF).sum();
    expect_slope_two(
        [&](double h) {
          return VecX::Constant(1, elastic_energy_density(F + h * dF, rotation_of(F + h * dF), kLame));
        },
        VecX::Constant(1, derivative), 1e-2, name);
  }
}

TEST(Corotated, ExactTangentIsTheDerivativeOfTheStress) {
  Random random(2);
  for (const auto& [name, stretches] : stretch_cases()) {
    const Mat3 F = deformation(random, stretches), dF = random.matrix();
    bool clamped = false;
    const Mat3 C = rotation_coupling(Tangent::kExact, F, rotation_of(F), kLame, clamped);
    EXPECT_FALSE(clamped);
    expect_slope_two(
        [&](double h) { return vec(elastic_stress(F + h * dF, rotation_of(F + h * dF), kLame)); },
        vec(elastic_stress_change(dF, rotation_of(F), C, kLame)), 1e-2, name);
  }
}

TEST(Corotated, HessianHasTheEigenvaluesOfTheTheory) {
  // Eigenvalues: 2 mu + 3 lambda once, 2 mu five times, 2 mu - 2 c/(s_i + s_j) for the three twist modes.
  Random random(3);
  for (const auto& [name, s] : stretch_cases()) {
    const double c = 2 * kLame.mu - kLame.lambda * (s.sum() - 3);
    VecX expected(9);
    expected << 2 * kLame.mu + 3 * kLame.lambda, VecX::Constant(5, 2 * kLame.mu),
        2 * kLame.mu - 2 * c / (s[0] + s[1]), 2 * kLame.mu - 2 * c / (s[0] + s[2]),
        2 * kLame.mu - 2 * c / (s[1] + s[2]);
    std::sort(expected.begin(), expected.end());
    const VecX found =
        Eigen::SelfAdjointEigenSolver<Mat9>(hessian(deformation(random, s), Tangent::kExact)).eigenvalues();
    EXPECT_LT((found - expected).norm(), 1e-11 * expected.norm()) << name;
  }
}

TEST(Corotated, ProjectedEqualsTheNumericProjection) {
  Random random(4);
  int changed = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 stretches = Vec3(1.6, 1.2, 0.3) + 0.5 * Vec3(random.vector(3));  // third stretch: -0.2 to 0.8
    const Mat3 F = deformation(random, stretches);
    const Mat9 exact = hessian(F, Tangent::kExact), projected = hessian(F, Tangent::kProjected);
    EXPECT_LT((projected - numeric_projection(exact)).norm(), 1e-10 * exact.norm());
    if ((projected - exact).norm() > 1e-6) ++changed;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Mat9>(projected).eigenvalues()[0], -1e-12 * exact.norm());
  }
  EXPECT_GT(changed, 50);  // both branches were taken
  EXPECT_LT(changed, 200);
}

TEST(Corotated, ProjectedAtRestAndAtTheSingularSetIsSemiDefiniteAndFinite) {
  Random random(5);
  for (const Vec3& s : {Vec3(1, 1, 1), Vec3(1, 0, 0), Vec3(0, 0, 0), Vec3(1, 0.5, -0.5)}) {
    const Mat9 H = hessian(deformation(random, s), Tangent::kProjected);
    ASSERT_TRUE(H.allFinite());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Mat9>(H).eigenvalues()[0], -1e-12 * H.norm());
  }
}

TEST(Corotated, ExactIsClampedAndFiniteAtTheSingularSet) {
  Random random(6);
  for (const Vec3& s : {Vec3(1, 0, 0), Vec3(0, 0, 0), Vec3(1, 0.5, -0.5)}) {
    bool clamped = false;
    EXPECT_TRUE(hessian(deformation(random, s), Tangent::kExact, &clamped).allFinite());
    EXPECT_TRUE(clamped);
  }
}

TEST(Corotated, AllTangentsAgreeAtRestUnderAnyRotation) {
  Random random(7);
  const Mat3 R = random.rotation();
  const Mat9 exact = hessian(R, Tangent::kExact);
  EXPECT_LT((hessian(R, Tangent::kWarped) - exact).norm(), 1e-13 * exact.norm());
  EXPECT_LT((hessian(R, Tangent::kProjected) - exact).norm(), 1e-13 * exact.norm());
}

TEST(Corotated, BlocksContractTheStressChange) {
  // K_ab w = V dP(w g_b^T) g_a
  Random random(8);
  const Mat3 F = deformation(random, {1.3, 0.9, -0.4}), gradients = random.matrix(), F_dot = random.matrix();
  const Mat3 R = rotation_of(F);
  bool clamped = false;
  const double V = 0.37;
  for (Tangent tangent : {Tangent::kExact, Tangent::kProjected, Tangent::kWarped}) {
    const Mat3 C = rotation_coupling(tangent, F, R, kLame, clamped);
    ElementBlocks K, D, Kd;
    K.fill(Mat3::Zero());
    D.fill(Mat3::Zero());
    Kd.fill(Mat3::Zero());
    add_elastic_blocks(gradients, R, C, kLame, V, K);
    add_damping_blocks(gradients, F, kDamping, V, D);
    add_damping_position_blocks(gradients, F, F_dot, kDamping, V, Kd);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const Vec3 w = random.vector(3);
        const Mat3 dF = w * gradients.row(b);
        const Vec3 g = gradients.row(a).transpose();
        const auto block = static_cast<std::size_t>(3 * a + b);
        EXPECT_LT((K[block] * w - V * elastic_stress_change(dF, R, C, kLame) * g).norm(), 1e-12);
        EXPECT_LT((D[block] * w - V * F * damping_stress(strain_rate(F, dF), kDamping) * g).norm(), 1e-12);
        const Mat3 by_position = dF * damping_stress(strain_rate(F, F_dot), kDamping) +
                                 F * damping_stress(strain_rate(dF, F_dot), kDamping);
        EXPECT_LT((Kd[block] * w - V * by_position * g).norm(), 1e-12);
      }
  }
}

TEST(Corotated, WarpedBlocksAreTheRotatedStiffnessOfLinearElasticity) {
  // K_linear,ab = V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I); warped: R K R^T (Mueller and Gross
  // 2004, eq. 7).
  Random random(9);
  const Mat3 R = random.rotation(), gradients = random.matrix();
  ElementBlocks K;
  K.fill(Mat3::Zero());
  bool clamped = false;
  add_elastic_blocks(gradients, R, rotation_coupling(Tangent::kWarped, R, R, kLame, clamped), kLame, 2.0, K);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const Vec3 ga = gradients.row(a), gb = gradients.row(b);
      const Mat3 linear = kLame.lambda * ga * gb.transpose() + kLame.mu * gb * ga.transpose() +
                          kLame.mu * ga.dot(gb) * Mat3::Identity();
      EXPECT_LT((K[static_cast<std::size_t>(3 * a + b)] - 2.0 * R * linear * R.transpose()).norm(), 1e-12);
    }
}
