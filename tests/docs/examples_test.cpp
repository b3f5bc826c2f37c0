// docs/extending.md quotes the files of examples/: each behaves as described there.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "docs/examples/capsule.cpp"  // its class is in an unnamed namespace
#include "fem/law.h"
#include "integrate/fakes.h"
#include "palpate/contact/obstacle.h"
#include "palpate/device/device.h"
#include "validation.h"

namespace palpate {
namespace device {
std::unique_ptr<Device> make_circling(const DeviceSpec&, const std::string&);
}
namespace integrate {
std::unique_ptr<dynamics::Stepper> make_heun(dynamics::System&, dynamics::State&, const IntegratorSpec&,
                                             std::unique_ptr<dynamics::LinearSolver>);
}
namespace contact {
const ObstacleEntry& capsule_obstacle();
}
namespace fem::laws {
extern const Law saint_venant;
}
namespace validation {
ValidationCase inner_forces();
}
}  // namespace palpate

using namespace palpate;

namespace {

std::mt19937 engine(20070322);
double uniform() { return std::uniform_real_distribution<double>(-1.0, 1.0)(engine); }
Vec3 vector() { return {uniform(), uniform(), uniform()}; }
Mat3 matrix() {
  Mat3 out;
  for (int i = 0; i < 3; ++i) out.col(i) = vector();
  return out;
}

/// Observed order of |error(h)| = C h^order between two steps.
double order(double coarse, double fine) { return std::log2(coarse / fine); }

TEST(Examples, DeviceCircles) {
  const auto device = device::make_circling({}, {});
  const double h = 1e-5;
  const Vec3 before = device->sample(0.3 - h).pose.translation;
  const device::HandleSample now = device->sample(0.3);
  const Vec3 after = device->sample(0.3 + h).pose.translation;
  EXPECT_NEAR(now.pose.translation.norm(), 0.01, 1e-15);
  EXPECT_LT(((after - before) / (2.0 * h) - now.twist.linear).norm(), 1e-9);
  EXPECT_LT(((after - 2.0 * now.pose.translation + before) / (h * h) - now.acceleration.linear).norm(), 1e-5);
  device->set_force_and_torque(Vec3(1.0, 0.0, 0.0), Vec3::Zero());
  device->close();
  EXPECT_FALSE(device->is_open());
}

double heun_error(int steps) {
  fakes::Chain chain;
  chain.start_in_mode(0.1);
  const double T = 1.0 / chain.omega();
  IntegratorSpec spec;
  spec.step_s = T / steps;
  const auto stepper = integrate::make_heun(chain.system, chain.state, spec, nullptr);
  EXPECT_TRUE(stepper->advance_to(T).ok());
  return (chain.state.q() - chain.term->q0 - 0.1 * std::cos(1.0) * chain.mode()).norm();
}

TEST(Examples, IntegratorIsOfOrderTwo) {
  const double coarse = heun_error(40), fine = heun_error(80);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_GT(order(coarse, fine), 1.9);
  EXPECT_LT(order(coarse, fine), 2.1);
}

TEST(Examples, ObstacleIsTheSetOfPointsNearAnAxis) {
  const contact::ObstacleEntry& entry = contact::capsule_obstacle();
  ObstacleSpec spec{
      "thing",
      entry.name,
      {{"radius_m", 0.2}, {"length_m", 0.6}, {"position_m", vector()}, {"rotation_vector_rad", vector()}}};
  const Settings shape = complete(entry.keys, spec.shape, "capsule");
  const Pose pose{quaternion_of(std::get<Vec3>(shape.at("rotation_vector_rad"))),
                  std::get<Vec3>(shape.at("position_m"))};
  int inside = 0;
  for (int k = 0; k < 300; ++k) {
    const Vec3 x = pose.translation + 0.45 * vector();
    double nearest = 1e9;  // distance to the axis, minimised over sampled points
    for (int i = 0; i <= 4000; ++i)
      nearest = std::min(nearest, (x - pose * Vec3(0.0, 0.0, -0.3 + 0.6 * i / 4000.0)).norm());
    const contact::Nearest at = entry.nearest(shape, x);
    EXPECT_NEAR(at.gap, nearest - 0.2, 1e-4);
    EXPECT_NEAR(at.normal.norm(), 1.0, 1e-14);
    EXPECT_NEAR(entry.nearest(shape, x - at.gap * at.normal).gap, 0.0, 1e-12) << "the way out";
    inside += at.gap < 0.0;
  }
  EXPECT_GT(inside, 20);
  const TriMesh surface = entry.surface(shape, 0.05);
  for (const auto x : surface.vertices.colwise()) EXPECT_NEAR(entry.nearest(shape, x).gap, 0.0, 1e-12);
  contact::Capsule capsule(pose, 0.2, 0.6);
  capsule.move_to({});
  int left = 0, crossed = 0;
  for (int k = 0; k < 300; ++k) {
    const Vec3 x = pose.translation + 0.6 * vector(), n = vector().normalized(),
               to = pose.translation + 0.6 * vector();
    double last = -1e9, deepest = 1e9;  // minimised over sampled points along the line
    for (int i = 0; i <= 4000; ++i) {
      const double s = -2.0 + i / 1000.0;
      if (capsule.at(x + s * n).gap < 0.0) last = s;
      deepest = std::min(deepest, capsule.at(x + i / 4000.0 * (to - x)).gap);
    }
    const double height = capsule.height(x, n);
    if (last > -1e9) {
      EXPECT_NEAR(height, last, 1.1e-3);
      EXPECT_NEAR(capsule.at(x + height * n).gap, 0.0, 1e-12);
    }
    left += last > -1e9;
    const bool outside = capsule.at(x).gap > 0.0 && capsule.at(to).gap > 0.0;
    if (std::abs(deepest) > 1e-4) { EXPECT_EQ(capsule.is_crossed(x, to), outside && deepest < 0.0); }
    crossed += outside && deepest < 0.0;
  }
  EXPECT_GT(left, 50);
  EXPECT_GT(crossed, 20);
  EXPECT_EQ(capsule.height(pose.translation + Vec3(9.0, 0.0, 0.0), Vec3::UnitY()),
            -std::numeric_limits<double>::infinity());
  const TriMesh picture = entry.picture(shape, {}).surface;
  ASSERT_GT(picture.vertices.cols(), 100);
  for (Eigen::Index v = 0; v < picture.vertices.cols(); ++v)
    EXPECT_NEAR(entry.nearest(shape, picture.vertices.col(v)).gap, 0.0, 1e-9);
}

TEST(Examples, MaterialsStressAndTangentAreDerivatives) {
  const fem::Law& law = fem::laws::saint_venant;
  const fem::Lame lame{3.0, 5.0};
  EXPECT_EQ(law.energy_density(Mat3::Identity(), lame), 0.0);
  for (int k = 0; k < 20; ++k) {
    const Mat3 F = Mat3::Identity() + 0.3 * matrix(), dF = matrix();
    const auto energy_error = [&](double h) {
      return std::abs(law.energy_density(F + h * dF, lame) - law.energy_density(F, lame) -
                      h * law.stress(F, lame).cwiseProduct(dF).sum());
    };
    const auto stress_error = [&](double h) {
      return (law.stress(F + h * dF, lame) - law.stress(F, lame) -
              h * law.stress_change(fem::Tangent::kExact, F, dF, lame))
          .norm();
    };
    EXPECT_NEAR(order(energy_error(2e-4), energy_error(1e-4)), 2.0, 0.05);
    EXPECT_NEAR(order(stress_error(2e-4), stress_error(1e-4)), 2.0, 0.05);
    const Mat3 crushed = 0.3 * F;
    EXPECT_GE(law.stress_change(fem::Tangent::kProjected, crushed, dF, lame).cwiseProduct(dF).sum(), -1e-12);
  }
  // small strain: 2 mu eps + lambda tr(eps) I
  const Mat3 G = matrix(), eps = 0.5 * (G + G.transpose());
  const Mat3 linear = 2.0 * lame.mu * eps + lame.lambda * eps.trace() * Mat3::Identity();
  EXPECT_LT((law.stress(Mat3::Identity() + 1e-7 * G, lame) / 1e-7 - linear).norm(), 1e-4);
}

TEST(Examples, CaseHoldsAndFindsItsFault) {
  const validation::ValidationCase one = validation::inner_forces();
  const auto sound = one.run("");
  ASSERT_EQ(sound.size(), 2u);
  for (const auto& measurement : sound) EXPECT_TRUE(measurement.passed()) << measurement.quantity;
  ASSERT_EQ(one.faults.size(), 1u);
  EXPECT_TRUE(one.faults[0].is_found(one.run(one.faults[0].name)));
}

}  // namespace
