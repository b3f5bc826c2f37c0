#include <gtest/gtest.h>

#include "integrate/fixed_steppers.h"

namespace palpate {
namespace {

using namespace fakes;
using namespace hand_steppers;
using Mat2 = Eigen::Matrix2d;
using Vec2 = Eigen::Vector2d;

// --- Amplification of a mode: y = (q, u/w), y' = w G y, so that a step depends on W = w h only.

Mat2 generator(double z) { return (Mat2() << 0, 1, -1, -2 * z).finished(); }
Mat2 matrix_of(const std::string& name, double W, double z) {
  const Mat2 I = Mat2::Identity(), Z = W * generator(z);
  if (name == "backward-euler" || name == "linearly-implicit-euler")
    return (Mat2() << 1 + 2 * z * W, W, -W, 1).finished() / (1 + 2 * z * W + W * W);  // (I - Z)^-1 by hand
  // (I - Z/2)^-1 (I + Z/2) by hand
  if (name == "implicit-midpoint" || name == "newmark") {
    const double d = 1 + z * W + W * W / 4;
    return (Mat2() << 1 + z * W - W * W / 4, W, -W, 1 - z * W - W * W / 4).finished() / d;
  }
  if (name == "symplectic-euler")
    return (Mat2() << 1 - W * W, W * (1 - 2 * z * W), -W, 1 - 2 * z * W).finished();
  return I + Z + Z * Z / 2 + Z * Z * Z / 6 + Z * Z * Z * Z / 24;  // rk4
}

TEST(HandSteppers, AmplifyAModeByTheClosedForm) {
  int counted = 0;
  for (const std::string name : {"linearly-implicit-euler", "backward-euler", "implicit-midpoint", "newmark",
                                 "symplectic-euler", "rk4"})
    for (const double W : {0.01, 0.3, 1.0, 10.0, 1000.0})
      for (const double z : {0.0, 0.1, 1.0, 5.0}) {
        if (is_explicit(name) && W > 1.0) continue;
        const double w = 7.0;
        Oscillator o(w, z, 0.3, -0.7 * w);
        const auto stepper = integrate::make_stepper(o.system, o.state, spec_of(name, W / w));
        Vec2 y = o.scaled();
        for (int n = 1; n <= 3; ++n) {
          ASSERT_TRUE(stepper->advance_to(n * (W / w)).ok());
          y = matrix_of(name, W, z) * y;
          const double rounding = name == "newmark" ? 1e-15 * W * W : 0.0;  // rounding of the acceleration a
          EXPECT_LT((o.scaled() - y).norm(), (1e-12 + rounding) * std::max(1.0, y.norm()))
              << name << ", W = " << W << ", z = " << z << ", step " << n;
          ++counted;
        }
      }
  EXPECT_EQ(counted, 3 * 4 * (4 * 5 + 2 * 3));
}

// The first step is Alexander's SDIRK, R(Z) = (I - s Z)^-2 (I + (1 - 2 s) Z); then 3/2 y2 - 2 y1 + 1/2 y0 = Z
// y2.
class Bdf2 : public testing::TestWithParam<const char*> {};
// On a linear problem the linearized method is the method.
INSTANTIATE_TEST_SUITE_P(Both, Bdf2, testing::Values("bdf2", "linearly-implicit-bdf2"));

TEST_P(Bdf2, AmplifiesAModeByTheClosedForm) {
  const double s = 1.0 - std::sqrt(0.5), w = 7.0;
  const Mat2 I = Mat2::Identity();
  for (const double W : {0.01, 0.3, 1.0, 10.0, 1000.0})
    for (const double z : {0.0, 0.1, 1.0, 5.0}) {
      Oscillator o(w, z, 0.3, -0.7 * w);
      const auto stepper = integrate::make_stepper(o.system, o.state, spec_of(GetParam(), W / w));
      const Mat2 Z = W * generator(z), inverse = (I - s * Z).inverse();
      Vec2 before, y = o.scaled();
      for (int n = 1; n <= 4; ++n) {
        ASSERT_TRUE(stepper->advance_to(n * (W / w)).ok());
        const Vec2 next = n == 1 ? Vec2(inverse * (inverse * ((I + (1 - 2 * s) * Z) * y)))
                                 : Vec2((1.5 * I - Z).inverse() * (2.0 * y - 0.5 * before));
        before = y;
        y = next;
        EXPECT_LT((o.scaled() - y).norm(), 1e-12) << "W = " << W << ", z = " << z << ", step " << n;
      }
    }
}

// Two consecutive steps of 0.6 and 1: the variable-step formula with r = 1/0.6, from y_before = y(t0).
TEST_P(Bdf2, TakesAChangedStepByItsCoefficients) {
  const double w = 2.0, z = 0.2, h0 = 0.06, h1 = 0.1, r = h1 / h0;
  Oscillator o(w, z, 0.3, 0.2);
  const auto stepper = integrate::make_stepper(o.system, o.state, spec_of(GetParam(), 0.1));
  const Vec2 y0 = o.scaled();
  ASSERT_TRUE(stepper->advance_to(h0).ok());
  const Vec2 y1 = o.scaled();
  ASSERT_TRUE(stepper->advance_to(h0 + h1).ok());
  // y' of the parabola through the three points: (1 + 2r)/(1 + r) y2 - (1 + r) y1 + r^2/(1 + r) y0 = h1 w G
  // y2.
  const Mat2 A = (1 + 2 * r) / (1 + r) * Mat2::Identity() - h1 * w * generator(z);
  const Vec2 y2 = A.inverse() * ((1 + r) * y1 - r * r / (1 + r) * y0);
  EXPECT_LT((o.scaled() - y2).norm(), 1e-13);
}

// (q, h u, h^2 a) <- B^-1 C of Chung and Hulbert's four equations, written out.
TEST(GeneralizedAlpha, AmplifiesAModeByTheClosedForm) {
  const double w = 7.0;
  for (const double rho : {0.0, 0.5, 0.8, 1.0})
    for (const double W : {0.01, 0.3, 1.0, 10.0, 1000.0})
      for (const double z : {0.0, 0.1, 1.0}) {
        const double am = (2 * rho - 1) / (rho + 1), af = rho / (rho + 1), g = 0.5 - am + af,
                     b = 0.25 * (1 - am + af) * (1 - am + af);
        Mat3 B, C;
        B << 1, 0, -b, 0, 1, -g, (1 - af) * W * W, (1 - af) * 2 * z * W, 1 - am;
        C << 1, 1, 0.5 - b, 0, 1, 1 - g, -af * W * W, -af * 2 * z * W, -am;
        const Mat3 A = B.inverse() * C;
        Oscillator o(w, z, 0.3, -0.7 * w);
        IntegratorSpec s = spec_of("generalized-alpha", W / w);
        s.spectral_radius = rho;
        const auto stepper = integrate::make_stepper(o.system, o.state, s);
        Vec3 y(0.3, -0.7 * W, W * W * (-0.3 + 2 * z * 0.7));
        double largest = 1.0;
        for (int n = 1; n <= 5; ++n) {
          ASSERT_TRUE(stepper->advance_to(n * (W / w)).ok());
          y = A * y;
          largest = std::max(largest, std::max(std::abs(y[0]), std::abs(y[1] / W)));
          EXPECT_LT((o.scaled() - Vec2(y[0], y[1] / W)).norm(), (1e-12 + 1e-15 * W * W) * largest)
              << "rho = " << rho << ", W = " << W << ", z = " << z << ", step " << n;
        }
      }
}

// A contact query changes the force only: a and g are continued, because M^-1 f of a stiff force is
// unbounded.
TEST(GeneralizedAlpha, GoesOnWhereContactIsRefreshed) {
  const double h = 0.01;
  Oscillator whole(1.0, 1e6 / (2.0 * h), 0.0, 1.0), refreshed(1.0, 1e6 / (2.0 * h), 0.0, 1.0);
  const auto one = integrate::make_stepper(whole.system, whole.state, spec_of("generalized-alpha", h)),
             other =
                 integrate::make_stepper(refreshed.system, refreshed.state, spec_of("generalized-alpha", h));
  for (int n = 1; n <= 20; ++n) {
    ASSERT_TRUE(one->advance_to(n * h).ok());
    ASSERT_TRUE(other->advance_to(n * h).ok());
    EXPECT_NEAR(whole.state.q()[0], refreshed.state.q()[0], 1e-9 * std::abs(whole.state.q()[0])) << n;
    EXPECT_NEAR(whole.state.u()[0], refreshed.state.u()[0], 1e-9 * std::abs(whole.state.u()[0])) << n;
    if (n % 2 == 0) other->reinit(ReinitReason::kContactRefreshed);
  }
}

// All three roots tend to -rho: (E + rho)^3 q = 0, with E the shift by one step.
TEST(GeneralizedAlpha, HasItsSpectralRadiusAtInfinity) {
  for (const double rho : {0.0, 0.3, 0.8, 1.0}) {
    Oscillator o(1.0, 0.0, 0.3, 0.5);
    IntegratorSpec s = spec_of("generalized-alpha", 1e4);
    s.spectral_radius = rho;
    const auto stepper = integrate::make_stepper(o.system, o.state, s);
    std::vector<double> q;
    for (int n = 1; n <= 8; ++n) {
      ASSERT_TRUE(stepper->advance_to(1e4 * n).ok());
      q.push_back(o.state.q()[0]);
    }
    for (std::size_t n = 0; n + 3 < q.size(); ++n) {
      const double size = std::abs(q[n + 3]) + 3 * rho * std::abs(q[n + 2]) +
                          3 * rho * rho * std::abs(q[n + 1]) + rho * rho * rho * std::abs(q[n]);
      EXPECT_NEAR(q[n + 3] + 3 * rho * q[n + 2] + 3 * rho * rho * q[n + 1] + rho * rho * rho * q[n], 0.0,
                  1e-6 * std::max(size, 1.0))
          << "rho = " << rho;
    }
  }
}

// --- Conserved and bounded quantities

TEST(HandSteppers, KeepTheEnergyOfALinearSystemWhereTheoryDoes) {
  for (const std::string name : {"implicit-midpoint", "newmark"}) {
    Chain chain;
    chain.start_in_mode(0.1);
    chain.state.u()[7] = 0.3;  // and other modes
    const auto energy = [&] {
      return chain.system.kinetic_energy(chain.state.view()) +
             chain.system.potential_energy(chain.state.view());
    };
    const double before = energy();
    const auto stepper = integrate::make_stepper(chain.system, chain.state, spec_of(name, 0.05));
    for (int i = 1; i <= 100; ++i) {
      ASSERT_TRUE(stepper->advance_to(0.5 * i).ok());
      EXPECT_NEAR(energy(), before, 1e-12 * before) << name;
    }
  }
}

/// Growth of (q, u/w) over 2000 steps of W/w, or the failure status.
StepResult excite(const std::string& name, double W, double z, double& growth) {
  Oscillator o(3.0, z, 0.3, 0.2);
  const auto stepper = integrate::make_stepper(o.system, o.state, spec_of(name, W / o.w));
  const double before = o.scaled().norm();
  const StepResult result = stepper->advance_to(2000 * W / o.w);
  growth = o.scaled().norm() / before;
  EXPECT_TRUE(o.state.q().allFinite() && o.state.u().allFinite());
  return result;
}

TEST(SymplecticEuler, IsStableUpToItsLimitAndNotBeyond) {
  for (const double z : {0.0, 0.1, 0.5}) {
    const double limit = 2.0 * (std::sqrt(1.0 + z * z) - z);
    double growth = 0.0;
    EXPECT_TRUE(excite("symplectic-euler", 0.99 * limit, z, growth).ok());
    EXPECT_LT(growth, 20.0) << z;
    EXPECT_TRUE(excite("symplectic-euler", 1.01 * limit, z, growth).ok());
    EXPECT_GT(growth, 1e6) << z;
  }
}

TEST(RungeKutta4, IsStableUpToItsLimitAndNotBeyond) {
  double growth = 0.0;
  EXPECT_TRUE(excite("rk4", 0.99 * std::sqrt(8.0), 0.0, growth).ok());
  EXPECT_LT(growth, 1.0);
  EXPECT_TRUE(excite("rk4", 1.02 * std::sqrt(8.0), 0.0, growth).ok());
  EXPECT_GT(growth, 1e6);
}

TEST(HandSteppers, EndAnExplosionWithAFiniteState) {
  for (const std::string name : {"symplectic-euler", "rk4"}) {
    double growth = 0.0;
    const StepResult result = excite(name, 30.0, 0.0, growth);
    EXPECT_EQ(result.status, StepStatus::kNotFinite);
    EXPECT_NE(result.message.find(name + ": the force or the velocity is not finite; step_s of an explicit "
                                         "method must be below its stability limit (t = "),
              std::string::npos)
        << result.message;
    EXPECT_NE(result.message.find(", h = 10)"), std::string::npos) << result.message;
  }
}

}  // namespace
}  // namespace palpate
