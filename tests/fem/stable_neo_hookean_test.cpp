#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/polar.h"
#include "law_reference.h"

// Properties specific to the stable neo-Hookean law. Properties of every law are tested in laws_test.cpp.

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;
using Mat9 = Eigen::Matrix<double, 9, 9>;

namespace {

const Lame kLame{1.1, 2.3};
const Law& law() { return law_called("stable_neo_hookean"); }

/// Smith, de Goes and Kim 2018, eq. 14, in the paper's form, as a function of the stretches.
double paper_energy(const Vec3& s, const Lame& lame) {
  const double mu = 4.0 / 3.0 * lame.mu, lambda = lame.lambda + 5.0 / 6.0 * lame.mu;
  const double alpha = 1.0 + mu / lambda - mu / (4.0 * lambda);
  const double I = s.squaredNorm(), J = s.prod();
  return 0.5 * mu * (I - 3.0) + 0.5 * lambda * (J - alpha) * (J - alpha) - 0.5 * mu * std::log(I + 1.0);
}

/// Root of f by bisection between points at which f has opposite signs, to rounding.
double root(const std::function<double(double)>& f, double low, double high) {
  EXPECT_LT(f(low), 0.0);
  EXPECT_GT(f(high), 0.0);
  for (int i = 0; i < 200; ++i) (f(0.5 * (low + high)) < 0.0 ? low : high) = 0.5 * (low + high);
  return low;
}

}  // namespace

TEST(StableNeoHookean, EnergyIsThatOfThePaperCountedFromRest) {
  Random random(1);
  for (const auto& [name, s] : stretch_cases()) {
    const double expected = paper_energy(s, kLame) - paper_energy(Vec3::Ones(), kLame);
    EXPECT_NEAR(law().energy_density(deformation(random, s), kLame), expected, 1e-12 * expected) << name;
  }
}

TEST(StableNeoHookean, HessianHasTheEigenvaluesOfTheTheory) {
  // Eigenvalues: twists a + d s_k, flips a - d s_k; the stretch modes have the eigenvalues of the energy's
  // Hessian as a function of the stretches, here by differences.
  Random random(3);
  const double m = 4.0 / 3.0 * kLame.mu, l = kLame.lambda + 5.0 / 6.0 * kLame.mu;
  for (const auto& [name, s] : stretch_cases()) {
    const double a = m - m / (s.squaredNorm() + 1.0), d = l * (s.prod() - 1.0) - 0.75 * m;
    VecX expected(9);
    for (int k = 0; k < 3; ++k) expected[2 * k] = a + d * s[k], expected[2 * k + 1] = a - d * s[k];
    Mat3 A;
    const double h = 1e-4;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const Vec3 p = h * Vec3::Unit(i), q = h * Vec3::Unit(j);
        A(i, j) = (paper_energy(s + p + q, kLame) - paper_energy(s + p - q, kLame) -
                   paper_energy(s - p + q, kLame) + paper_energy(s - p - q, kLame)) /
                  (4.0 * h * h);
      }
    expected.tail<3>() = Eigen::SelfAdjointEigenSolver<Mat3>(A).eigenvalues();
    std::sort(expected.begin(), expected.end());
    const Mat3 F = deformation(random, s);
    Mat9 H;
    for (int i = 0; i < 9; ++i) {
      Mat3 dF = Mat3::Zero();
      dF(i % 3, i / 3) = 1.0;
      H.col(i) = law().stress_change(Tangent::kExact, F, dF, kLame).reshaped();
    }
    const VecX found = Eigen::SelfAdjointEigenSolver<Mat9>(H).eigenvalues();
    EXPECT_LT((found - expected).norm(), 1e-6 * expected.norm()) << name;
  }
}

TEST(StableNeoHookean, UniaxialStretchIsThatOfThePrincipalStretches) {
  // F = diag(s, t, t) with free sides: t minimises the energy at this s, and the stress is the energy's
  // derivative by s.
  for (const double poisson : {0.0, 0.3, 0.45}) {
    const Material material{.youngs_modulus = 3.0, .poissons_ratio = poisson};
    const Lame lame{material.mu(), material.lambda()};
    for (const double s : {0.3, 0.9, 1.001, 1.5, 4.0}) {
      const auto by_t = [&](double t) { return law().stress(Vec3(s, t, t).asDiagonal(), lame)(1, 1); };
      const double t = root(by_t, 1e-3, 4.0), h = 1e-5;
      const auto least = [&](double at) { return paper_energy({at, t, t}, lame); };
      EXPECT_LT(paper_energy({s, t, t}, lame), paper_energy({s, t + 1e-4, t + 1e-4}, lame));
      EXPECT_LT(paper_energy({s, t, t}, lame), paper_energy({s, t - 1e-4, t - 1e-4}, lame));
      const double stress = law().stress(Vec3(s, t, t).asDiagonal(), lame)(0, 0);
      EXPECT_NEAR(stress, (least(s + h) - least(s - h)) / (2.0 * h), 1e-8);
      if (s == 1.001) {  // small strain: Hooke's law and Poisson's ratio
        EXPECT_NEAR(stress, material.youngs_modulus * 1e-3, 5e-6);
        EXPECT_NEAR(t - 1.0, -poisson * 1e-3, 1e-6);
      }
    }
  }
}

TEST(StableNeoHookean, APointGivesWayAndAFlatElementIsDrivenBack) {
  // Without the logarithm F = 0 would be a local minimum.
  EXPECT_LT(law().energy_density(1e-2 * Mat3::Identity(), kLame), law().energy_density(Mat3::Zero(), kLame));
  Random random(7);
  for (int i = 0; i < 20; ++i) {
    const SignedSvd svd = signed_svd(random.matrix());
    for (const double third : {0.0, -0.3, -1.0}) {
      const Mat3 F = svd.U * Vec3(1.1, 0.8, third).asDiagonal() * svd.V.transpose();
      const Mat3 out = svd.U * Vec3(0, 0, 1).asDiagonal() * svd.V.transpose();
      EXPECT_LT(law().stress(F, kLame).cwiseProduct(out).sum(), 0.0) << "third stretch " << third;
    }
  }
}

// From a flat, a point-like and an inverted state, a free body returns to rest by projected Newton steps that
// reduce the energy.
TEST(StableNeoHookean, RecoversFromFlatFromAPointAndFromInsideOut) {
  const TetMesh rest = jittered_cube(2, 0.1, 51);
  const Material material = soft_material();
  for (const Vec3& s : {Vec3(1.0, 1.0, 0.0), Vec3(0.02, 0.02, 0.02), Vec3(1.0, 0.9, -0.8)}) {
    SoftBody body("b", rest, material, {.tangent = Tangent::kProjected, .law = "stable_neo_hookean"}, 0);
    Random random(52);
    VecX x = flat(s.asDiagonal() * rest.nodes) + 1e-3 * random.vector(3 * rest.nodes.cols());
    const VecX still = VecX::Zero(x.size());
    const auto energy = [&](const VecX& at_x) { return body.energy(OneBody(at_x, still).state.view()); };
    const double begin = energy(x);
    double now = begin;
    for (int step = 0; step < 200 && now > 1e-14; ++step) {
      OneBody at(x, still);
      VecX f = still;
      body.add_force(at.state.view(), f);
      dynamics::PatternBuilder builder(at.state.layout());
      body.add_pattern(builder);
      dynamics::BorderedMatrix K;
      K.body = builder.build();
      body.add_tangent(at.state.view(), 1.0, 0.0, K);
      MatX A = K.to_dense();
      A.diagonal().array() += 1e-6 * A.norm();  // rigid motions are unconstrained
      const VecX direction = A.ldlt().solve(f);
      double length = 1.0;
      while (length > 1e-9 && energy(x + length * direction) >= now) length *= 0.5;
      x += length * direction;
      now = energy(x);
    }
    EXPECT_LT(now, 1e-12 * begin) << s.transpose();
    body.reset_counts();
    VecX f = still;
    OneBody at(x, still);
    body.add_force(at.state.view(), f);
    EXPECT_EQ(body.counts().inverted, 0);
  }
}
