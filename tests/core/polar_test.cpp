#include "core/polar.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>
#include <random>
#include <vector>

#include "palpate/core/pose.h"

using namespace palpate;

namespace {

Vec3 random_vector(std::mt19937& random, double scale) {
  std::uniform_real_distribution<double> uniform(-scale, scale);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

Mat3 random_rotation(std::mt19937& random) {
  return quaternion_of(random_vector(random, 3.0)).toRotationMatrix();
}

double distance_from_rotation(const Mat3& R) {
  return std::max((R.transpose() * R - Mat3::Identity()).cwiseAbs().maxCoeff(),
                  std::abs(R.determinant() - 1.0));
}

/// F = U diag(sigma) V^T with random rotations: covers every sign pattern of singular values that a mesh may
/// produce.
struct Spectrum {
  const char* name;
  Vec3 sigma;
};
const std::vector<Spectrum> kSpectra = {
    {"rest", {1, 1, 1}},
    {"ordinary", {1.3, 0.9, 0.7}},
    {"stretched", {40, 1, 0.5}},
    {"squeezed", {1, 1, 0.051}},
    {"switch", {1, 1, 0.049}},
    {"nearly singular", {1, 0.8, 1e-9}},
    {"flat", {1, 0.8, 0}},
    {"rank one", {1, 0, 0}},
    {"zero", {0, 0, 0}},
    {"inverted", {1, 0.8, -0.3}},
    {"mirror image", {1, 1, -1}},
    {"nearly inverted", {1, 0.8, -1e-9}},
    {"tiny", {1e-9, 8e-10, 5e-10}},
    {"huge", {1e9, 8e8, 5e8}},
    {"thin and long", {1e4, 1, 1e-3}},
};

}  // namespace

TEST(Polar, RotationIsProperAndFactorIsSymmetricForEverySpectrum) {
  std::mt19937 random(1);
  int checked = 0;
  for (const auto& spectrum : kSpectra)
    for (int i = 0; i < 200; ++i, ++checked) {
      const Mat3 F = random_rotation(random) * spectrum.sigma.asDiagonal() * random_rotation(random);
      const double scale = std::max(spectrum.sigma[0], 1e-300);
      const Polar p = polar_decomposition(F);
      ASSERT_LE(distance_from_rotation(p.R), 1e-14) << spectrum.name;
      ASSERT_EQ(p.S, p.S.transpose()) << spectrum.name;
      ASSERT_LE((p.R * p.S - F).cwiseAbs().maxCoeff(), 1e-13 * scale) << spectrum.name;
    }
  EXPECT_EQ(checked, static_cast<int>(kSpectra.size()) * 200);
}

TEST(Polar, SignedSvdRebuildsItsMatrixWithProperRotations) {
  std::mt19937 random(2);
  for (const auto& spectrum : kSpectra)
    for (int i = 0; i < 200; ++i) {
      const Mat3 F = random_rotation(random) * spectrum.sigma.asDiagonal() * random_rotation(random);
      const SignedSvd svd = signed_svd(F);
      const double scale = std::max(spectrum.sigma[0], 1e-300);
      ASSERT_LE(distance_from_rotation(svd.U), 1e-14) << spectrum.name;
      ASSERT_LE(distance_from_rotation(svd.V), 1e-14) << spectrum.name;
      ASSERT_LE((svd.sigma - spectrum.sigma).cwiseAbs().maxCoeff(), 1e-14 * scale) << spectrum.name;
      ASSERT_LE((svd.U * svd.sigma.asDiagonal() * svd.V.transpose() - F).cwiseAbs().maxCoeff(), 1e-14 * scale)
          << spectrum.name;
      ASSERT_GE(svd.sigma[0], svd.sigma[1]);
      ASSERT_GE(svd.sigma[1], std::abs(svd.sigma[2]));
    }
}

// F = R0 S0 with S0 symmetric positive definite has this polar decomposition only.
TEST(Polar, FindsTheRotationThatTheMatrixWasMadeFrom) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> stretch(0.4, 1.8);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 R0 = random_rotation(random), Q = random_rotation(random);
    const double a = stretch(random), b = stretch(random), c = stretch(random);
    const Mat3 S0 = Q * Vec3(a, b, c).asDiagonal() * Q.transpose();
    const Polar p = polar_decomposition(R0 * S0);
    ASSERT_LE((p.R - R0).cwiseAbs().maxCoeff(), 1e-14);
    ASSERT_LE((p.S - S0).cwiseAbs().maxCoeff(), 1e-14);
  }
}

// Newton handles det F > 0.05, and the signed SVD the rest: both must give the same function on either
// side of the switch.
TEST(Polar, NewtonAgreesWithSignedSvd) {
  std::mt19937 random(4);
  int checked = 0;
  for (int i = 0; i < 2000; ++i) {
    const Mat3 F = Mat3::Identity() + cross_matrix(random_vector(random, 2.0)) +
                   Mat3(random_vector(random, 0.8).asDiagonal());
    if (F.determinant() < 0.02) continue;
    const SignedSvd svd = signed_svd(F);
    const double condition = svd.sigma[0] / (svd.sigma[1] + svd.sigma[2]);
    ASSERT_LE((polar_decomposition(F).R - svd.U * svd.V.transpose()).cwiseAbs().maxCoeff(),
              2e-14 * std::max(1.0, condition));
    ++checked;
  }
  EXPECT_GT(checked, 1500);
}

TEST(Polar, TurningTheMatrixTurnsTheRotation) {
  std::mt19937 random(5);
  const Mat3 F = (Mat3() << 1.1, 0.2, -0.1, 0.3, 0.8, 0.0, 0.1, -0.2, 1.2).finished();
  for (int i = 0; i < 100; ++i) {
    const Mat3 Q = random_rotation(random);
    ASSERT_LE((polar_decomposition(Q * F).R - Q * polar_decomposition(F).R).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(Polar, NonFiniteInputEndsAndStaysVisible) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Mat3 F = Mat3::Identity();
    F(1, 2) = bad;
    EXPECT_TRUE(signed_svd(F).sigma.hasNaN());
    EXPECT_TRUE(polar_decomposition(F).R.hasNaN());
  }
}

TEST(Polar, ExtremeMagnitudesStayFinite) {
  for (const double scale : {1e-300, 1e-150, 1e150, 1e300}) {
    const Polar p = polar_decomposition(scale * Mat3::Identity());
    EXPECT_LE((p.R - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-14) << scale;
  }
}
