#include "palpate/modes/modes.h"
#include "palpate/linear/solvers.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "integrate/fakes.h"
#include "palpate/core/error.h"

namespace palpate {
namespace {

using namespace fakes;
using modes::find_modes;
using modes::Modes;
using modes::ModesOptions;
constexpr auto kHighest = ModesOptions::End::kHighest;

/// A system of one node block with any stiffness and mass.
struct Dense {
  State state;
  System system;
  MatX K, M;

  Dense(MatX k, MatX m, std::vector<int> held = {}) : K(std::move(k)), M(std::move(m)) {
    BlockSpec spec;
    spec.name = "body";
    spec.q_size = spec.u_size = static_cast<int>(K.rows());
    const VecX rest = VecX::Zero(K.rows());
    const int block = state.insert(spec, rest, rest);
    term = std::make_shared<LinearTerm>(K, MatX::Zero(K.rows(), K.rows()), rest);
    system.add(std::static_pointer_cast<ForceTerm>(term));
    system.add(std::make_shared<NodalMass>(block, M));
    if (!M.isDiagonal()) system.set_mass_solver(linear::make_linear_solver("cholmod"));
    if (!held.empty())
      system.add(std::make_shared<Scripted>(
          held, [](double, VecX& x, VecX& v, VecX& a) { x.setZero(), v.setConstant(3.0), a.setZero(); }));
    system.prepare(state.view());
  }
  Modes modes(int count, ModesOptions::End end = ModesOptions::End::kLowest) {
    return find_modes(system, state.view(), {count, end});
  }
  std::shared_ptr<LinearTerm> term;
};

MatX random_matrix(int rows, int columns, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return MatX::NullaryExpr(rows, columns, [&] { return uniform(engine); });
}
/// Positive definite, eigenvalues from about 1 to 1e4 times `scale`.
MatX random_definite(int n, unsigned seed, double scale) {
  const MatX Q = MatX(random_matrix(n, n, seed)).householderQr().householderQ();
  return scale * (Q * VecX(VecX::LinSpaced(n, 0.0, 4.0).unaryExpr([](double e) {
                        return std::pow(10.0, e);
                      })).asDiagonal() *
                  Q.transpose());
}
/// All pairs of points connected by springs: no force resists the six rigid motions.
MatX spring_network(const MatX& points, double k) {
  const int n = static_cast<int>(points.cols());
  MatX K = MatX::Zero(3 * n, 3 * n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) {
      const Vec3 d = (points.col(i) - points.col(j)).normalized();
      const Mat3 s = k * d * d.transpose();
      K.block<3, 3>(3 * i, 3 * i) += s;
      K.block<3, 3>(3 * j, 3 * j) += s;
      K.block<3, 3>(3 * i, 3 * j) -= s;
      K.block<3, 3>(3 * j, 3 * i) -= s;
    }
  return K;
}

void expect_modes_of(const Dense& d, const Modes& modes) {
  EXPECT_TRUE(modes.converged);
  for (int j = 0; j < modes.count(); ++j) {
    const VecX phi = modes.shapes.col(j), force = d.K * phi;
    EXPECT_LE(modes.residuals[j], 1e-8) << j;
    EXPECT_LE((force - modes.omega_squared[j] * (d.M * phi)).norm(),
              1e-8 * force.norm() + 1e-12 * d.K.norm() * phi.norm())
        << j;
  }
  EXPECT_LE((modes.shapes.transpose() * d.M * modes.shapes - MatX::Identity(modes.count(), modes.count()))
                .cwiseAbs()
                .maxCoeff(),
            1e-10);
}

// w_j = 2 sqrt(k) sin((2j - 1) pi/18); the eigenvalue k = 100 comes from j = 2 and from y and z: nine times
TEST(Modes, OfTheChainAreKnown) {
  Chain chain;
  const Modes modes = find_modes(chain.system, chain.state.view(), {5});
  ASSERT_EQ(modes.count(), 5);
  EXPECT_NEAR(modes.omega(0), chain.omega(), 1e-10 * chain.omega());
  EXPECT_NEAR(modes.frequency_hz(0), chain.omega() / (2.0 * M_PI), 1e-10 * chain.omega());
  const VecX phi = chain.mode().normalized();
  EXPECT_LE((modes.shapes.col(0) - phi).norm(), 1e-9) << "the largest entry is positive";
  for (int j = 1; j < 5; ++j) EXPECT_NEAR(modes.omega_squared[j], 100.0, 1e-9) << j;
  EXPECT_LE((modes.shapes.transpose() * modes.shapes - MatX::Identity(5, 5)).norm(), 1e-10)
      << "repeated modes, and each direction once";
  EXPECT_TRUE(modes.converged);
}

TEST(Modes, HighestOfTheChainComeFirstFromAbove) {
  Chain chain;
  const Modes modes = find_modes(chain.system, chain.state.view(), {3, kHighest});
  for (int j = 0; j < 3; ++j) {
    const double omega = 2.0 * std::sqrt(100.0) * std::sin((7 - 2 * j) * M_PI / 18);
    EXPECT_NEAR(modes.omega(j), omega, 1e-10 * omega) << j;
  }
}

TEST(Modes, AllOfThemWhereMoreAreWantedThanThereAre) {
  Chain chain;
  const Modes modes = find_modes(chain.system, chain.state.view(), {100});
  ASSERT_EQ(modes.count(), 12);
  EXPECT_NEAR(modes.omega_squared.sum(), 7 * 100.0 + 8 * 100.0, 1e-9) << "the trace of K";
}

TEST(Modes, EqualThoseOfADenseSolver) {
  for (const bool consistent : {false, true}) {
    const int n = 60;
    const MatX mass = consistent ? MatX(random_definite(n, 2, 1e-4))
                                 : MatX(VecX(random_matrix(n, 1, 2).cwiseAbs().array() + 0.1).asDiagonal());
    Dense d(random_definite(n, 1, 1e5), mass);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> dense(d.K, d.M);
    for (const auto end : {ModesOptions::End::kLowest, kHighest}) {
      const Modes modes = d.modes(6, end);
      expect_modes_of(d, modes);
      for (int j = 0; j < 6; ++j) {
        const double expected = dense.eigenvalues()[end == kHighest ? n - 1 - j : j];
        EXPECT_NEAR(modes.omega_squared[j], expected, 1e-9 * expected) << j;
      }
    }
  }
}

TEST(Modes, OfAFreeBodyBeginWithSixRigidMotions) {
  const MatX points = random_matrix(3, 30, 7);
  Dense d(spring_network(points, 1e6), 0.01 * MatX::Identity(90, 90));
  const Modes modes = d.modes(9);
  ASSERT_EQ(modes.count(), 9);
  for (int j = 0; j < 6; ++j) EXPECT_EQ(modes.omega_squared[j], 0.0) << j;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> dense(d.K, d.M);
  for (int j = 6; j < 9; ++j)
    EXPECT_NEAR(modes.omega_squared[j], dense.eigenvalues()[j], 1e-9 * dense.eigenvalues()[j]) << j;
  expect_modes_of(d, modes);
  // Translations and rotations lie in the span of the six.
  const MatX zero = modes.shapes.leftCols(6);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool turn : {false, true}) {
      VecX rigid(90);
      for (int i = 0; i < 30; ++i)
        rigid.segment<3>(3 * i) = turn ? Vec3(Vec3::Unit(axis).cross(Vec3(points.col(i)))) : Vec3::Unit(axis);
      EXPECT_LE((rigid - zero * (zero.transpose() * (d.M * rigid))).norm(), 1e-8 * rigid.norm()) << axis;
    }
}

TEST(Modes, OfNodesThatNothingHoldsAreAllRigid) {
  Dense d(MatX::Zero(30, 30), MatX::Identity(30, 30));
  const Modes modes = d.modes(4);
  EXPECT_TRUE(modes.converged);
  EXPECT_EQ(modes.omega_squared.cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(d.modes(4, kHighest).omega_squared.cwiseAbs().maxCoeff(), 0.0);
}

TEST(Modes, LeaveDrivenDirectionsOut) {
  const std::vector<int> held = {0, 1, 2, 17, 31};
  Dense d(random_definite(36, 3, 1e3), MatX::Identity(36, 36), held);
  std::vector<int> free;
  for (int i = 0; i < 36; ++i)
    if (std::find(held.begin(), held.end(), i) == held.end()) free.push_back(i);
  const Eigen::SelfAdjointEigenSolver<MatX> dense(MatX(d.K(free, free)));
  for (const auto end : {ModesOptions::End::kLowest, kHighest}) {
    const Modes modes = d.modes(4, end);
    for (int j = 0; j < 4; ++j) {
      const double expected = dense.eigenvalues()[end == kHighest ? 30 - j : j];
      EXPECT_NEAR(modes.omega_squared[j], expected, 1e-9 * expected) << j;
      for (int i : held) EXPECT_EQ(modes.shapes(i, j), 0.0) << "a drive that moves is no mode";
    }
  }
}

TEST(Modes, OfAnUnstableEquilibriumBeginWithNegativeSquares) {
  MatX K = random_definite(30, 4, 1.0);
  const Eigen::SelfAdjointEigenSolver<MatX> before(K);
  K -= 30.0 * MatX::Identity(30, 30);
  Dense d(K, MatX::Identity(30, 30));
  const Modes modes = d.modes(5);
  expect_modes_of(d, modes);
  for (int j = 0; j < 5; ++j) EXPECT_NEAR(modes.omega_squared[j], before.eigenvalues()[j] - 30.0, 1e-7) << j;
  EXPECT_LT(modes.omega_squared[0], -25.0);
  EXPECT_EQ(modes.omega(0), 0.0);
}

TEST(Modes, DoNotDependOnUnits) {
  const MatX K = random_definite(48, 5, 1.0);
  Dense a(K, MatX::Identity(48, 48)), b(1e13 * K, 1e-7 * MatX::Identity(48, 48));
  const Modes one = a.modes(5), other = b.modes(5);
  for (int j = 0; j < 5; ++j) EXPECT_NEAR(other.omega_squared[j] / one.omega_squared[j], 1e20, 1e11) << j;
  EXPECT_TRUE(one.converged && other.converged);
}

TEST(Modes, AreTheSameEveryTime) {
  const MatX K = random_definite(48, 6, 1.0);
  Dense a(K, MatX::Identity(48, 48)), b(K, MatX::Identity(48, 48));
  const Modes one = a.modes(5), other = b.modes(5);
  EXPECT_EQ(one.omega_squared, other.omega_squared);
  EXPECT_EQ(one.shapes, other.shapes);
}

TEST(Modes, RefuseWhatHasNone) {
  const auto message = [](Dense& d, int count) {
    try {
      d.modes(count);
    } catch (const Error& e) { return std::string(e.what()); }
    return std::string();
  };
  Dense d(MatX::Identity(6, 6), MatX::Identity(6, 6));
  EXPECT_NE(message(d, 0).find("at least 1"), std::string::npos);
  d.term->symmetric = false;
  EXPECT_NE(message(d, 1).find("unsymmetric"), std::string::npos);
  Dense held(MatX::Identity(3, 3), MatX::Identity(3, 3), {0, 1, 2});
  EXPECT_NE(message(held, 1).find("free to move"), std::string::npos);
  Dense broken(std::nan("") * MatX::Ones(30, 30), MatX::Identity(30, 30));
  EXPECT_NE(message(broken, 1).find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace palpate
