// Friction at the end of a step by repeated solves: one mass, with a known solution, and coupled masses.
#include "contact/friction.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace palpate::contact {
namespace {

constexpr double kViscous = 1e-4;  // v_r
const Vec3 kUp(0, 0, 1);

// m u = b + h f(u): u = sign(b) (|b| - h L)/m where that is above v_r, else b/(m + h L/v_r).
TEST(Friction, OneMassIsSolvedInThreeSolves) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  int slid = 0, stuck = 0, turned = 0;
  for (int i = 0; i < 300; ++i) {
    const double m = 0.2, h = 0.01, L = 5.0 * std::abs(in(random)), b = 0.1 * in(random),
                 u0 = 0.3 * in(random);
    FrictionGuess guess = first_guess(L, Vec3(u0, 0, 0), kViscous);
    double u = 0.0;
    int solves = 0;
    for (bool done = false; !done;) {
      const FrictionLine line = friction_line(guess, kUp);
      u = (b + h * line.constant.x()) / (m + h * line.D(0, 0));
      ASSERT_LE(++solves, 3);
      FrictionError error;
      const Vec3 v(u, 0, 0);
      error.add(line.constant - line.D * v, L, v, kViscous);
      end_solve(guess, L, v, line.constant - line.D * v);
      move_guesses({&guess, 1}, solves);
      done = error.relative() < 1e-12;
    }
    const double sliding = (std::abs(b) - h * L) / m;
    const double expected = sliding > kViscous ? std::copysign(sliding, b) : b / (m + h * L / kViscous);
    EXPECT_NEAR(u, expected, 1e-12) << "b " << b << ", L " << L << ", u0 " << u0;
    ++(sliding > kViscous ? slid : stuck);
    turned += sliding > kViscous && u * u0 < 0.0;
  }
  EXPECT_GT(slid, 50);
  EXPECT_GT(stuck, 20);
  EXPECT_GT(turned, 20);
}

// A chain of many masses that rub on a plane in both directions: within the number of solves of a step,
// friction is within the cone and opposes the velocity.
TEST(Friction, ChainsOfMassesEndWithinTheCone) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  constexpr int kMasses = 12;
  int most = 0;
  for (int i = 0; i < 300; ++i) {
    MatX A = MatX::Zero(3 * kMasses, 3 * kMasses);  // M + h^2 K
    for (int k = 0; k < kMasses; ++k) {
      A.block<3, 3>(3 * k, 3 * k) += 0.01 * Mat3::Identity();
      if (k == 0) continue;
      const Mat3 spring = 0.05 * Mat3::Identity();
      A.block<3, 3>(3 * k, 3 * k) += spring;
      A.block<3, 3>(3 * k - 3, 3 * k - 3) += spring;
      A.block<3, 3>(3 * k - 3, 3 * k) -= spring;
      A.block<3, 3>(3 * k, 3 * k - 3) -= spring;
    }
    VecX b(3 * kMasses), u(3 * kMasses);
    std::array<double, kMasses> L;
    std::array<FrictionGuess, kMasses> guess;
    for (int k = 0; k < kMasses; ++k) {
      b.segment<3>(3 * k) = 0.02 * Vec3(in(random) + 0.3, in(random), 0.0);
      L[static_cast<std::size_t>(k)] = 0.02 * std::abs(in(random));  // includes the factor h
      guess[static_cast<std::size_t>(k)] =
          first_guess(L[static_cast<std::size_t>(k)], 0.3 * Vec3(in(random), in(random), 0.0), kViscous);
    }
    double error_left = 1.0;
    int solves = 0;
    for (; solves < kFrictionSolves && error_left > kFrictionTolerance; ++solves) {
      MatX S = A;
      VecX rhs = b;
      for (int k = 0; k < kMasses; ++k) {
        const FrictionLine line = friction_line(guess[static_cast<std::size_t>(k)], kUp);
        S.block<3, 3>(3 * k, 3 * k) += line.D;
        rhs.segment<3>(3 * k) += line.constant;
      }
      u = S.partialPivLu().solve(rhs);
      FrictionError error;
      for (std::size_t k = 0; k < kMasses; ++k) {
        const Vec3 v = u.segment<3>(3 * static_cast<Eigen::Index>(k));
        const FrictionLine line = friction_line(guess[k], kUp);
        error.add(line.constant - line.D * v, L[k], v, kViscous);
        end_solve(guess[k], L[k], v, line.constant - line.D * v);
      }
      move_guesses(guess, solves + 1);
      error_left = error.relative();
    }
    EXPECT_LE(error_left, 1e-3) << i;
    most = std::max(most, solves);
  }
  EXPECT_GT(most, 2);
}

}  // namespace
}  // namespace palpate::contact
