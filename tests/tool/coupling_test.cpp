#include "coupling.h"

#include <gtest/gtest.h>

#include <random>

#include "core/so3.h"
#include "tick_input.h"
#include "tool_fixtures.h"

using namespace palpate;
using namespace palpate::tool;
using namespace palpate::tool::testing;

namespace {

std::mt19937 rng(11);
Vec3 random_vec(double size = 1.0) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return size * Vec3(uniform(rng), uniform(rng), uniform(rng));
}
Pose random_pose() { return {quaternion_of(random_vec()), random_vec()}; }
Pose moved(const Pose& pose, const Vec6& by) {
  return {quaternion_of(by.head<3>()) * pose.rotation, pose.translation + by.tail<3>()};
}
Vec6 random_vec6() {
  Vec6 v;
  v << random_vec(), random_vec();
  return v;
}

constexpr CouplingGains kGains{300.0, 2.0, 0.7, 0.02};

/// Fixture in which each test draws the same numbers, whichever ran before.
struct Seeded : ::testing::Test {
  Seeded() { rng.seed(11); }
};
struct So3 : Seeded {};
struct Coupling : Seeded {};
struct HandlePath : Seeded {};

}  // namespace

TEST_F(So3, jacobians_are_inverse_and_derivatives) {
  for (double angle : {0.0, 1e-9, 1e-3, 0.2499999, 0.25, 0.7, 2.0, 3.1}) {
    const Vec3 theta = angle * Vec3(2, -1, 2) / 3.0;
    EXPECT_LT((left_jacobian(theta) * left_jacobian_inverse(theta) - Mat3::Identity()).norm(), 2e-13)
        << angle;
    EXPECT_LT((left_jacobian_inverse(-theta) - left_jacobian_inverse(theta).transpose()).norm(), 1e-15);
    EXPECT_LT((left_jacobian(theta) * theta - theta).norm(), 1e-14);  // the axis is fixed
    if (angle < 0.1) continue;  // the difference is exact to rounding there, and has no order
    const Vec3 rate = random_vec();
    std::vector<double> e;
    for (double h = 0.04; h > 1e-3; h /= 2) {
      const Quat a = quaternion_of(theta - h * rate), b = quaternion_of(theta + h * rate);
      e.push_back((rotation_vector(b * a.conjugate()) / (2 * h) - left_jacobian(theta) * rate).norm());
    }
    for (std::size_t i = 1; i < e.size(); ++i) EXPECT_NEAR(std::log2(e[i - 1] / e[i]), 2.0, 0.1) << angle;
  }
}

// F(x exp(h d)) = F(x) - h K d + O(h^2): the remainder decreases by 4 as h halves, at random poses and near a
// rotation by pi.
TEST_F(Coupling, tangent_by_taylor) {
  for (int run = 0; run < 8; ++run) {
    const RigidMotion tool{random_pose(), twist_of(random_vec6())};
    RigidMotion handle{random_pose(), twist_of(random_vec6())};
    if (run % 2) handle.pose.rotation = quaternion_of(3.0 * random_vec().normalized()) * tool.pose.rotation;
    const Vec6 d = random_vec6(), dv = random_vec6();
    const Mat6 K = coupling_stiffness(kGains, tool.pose, handle.pose), B = coupling_damping(kGains);
    const Vec6 F0 = coupling_wrench(kGains, tool, handle);
    std::vector<double> hs, e;
    for (double h = 0.02; h > 5e-4; h /= 2) {
      const RigidMotion there{moved(tool.pose, h * d), twist_of(stacked(tool.twist) + h * dv)};
      hs.push_back(h);
      e.push_back((coupling_wrench(kGains, there, handle) - F0 + h * (K * d + B * dv)).head<3>().norm());
    }
    EXPECT_NEAR(slope(hs, e), 2.0, 0.1) << run;
    const RigidMotion there{moved(tool.pose, d), twist_of(stacked(tool.twist) + dv)};
    EXPECT_LT((coupling_wrench(kGains, there, handle) - F0 + K * d + B * dv).tail<3>().norm(), 1e-11)
        << "translation is linear";
  }
}

TEST_F(Coupling, contact_tangent_by_taylor) {
  for (int run = 0; run < 5; ++run) {
    dynamics::LinearisedContact record;
    record.source = dynamics::LinearisedContact::Source::kCondensed;
    for (int i = 0; i < 6; ++i) record.F0[i] = random_vec().x(), record.v0[i] = random_vec().x();
    for (int i = 0; i < 36; ++i) record.J[i] = random_vec().x(), record.B[i] = random_vec().x();
    const Quat r = quaternion_of(random_vec());
    record.x0 = {r.w(), r.x(), r.y(), r.z(), 0.1, 0.2, 0.3};
    const Pose tool = random_pose();
    const Vec6 v = random_vec6(), d = random_vec6(), dv = random_vec6();
    const Vec6 F0 = dynamics::contact_wrench(record, record.time, tool, twist_of(v));
    std::vector<double> hs, e;
    for (double h = 0.02; h > 5e-4; h /= 2) {
      hs.push_back(h);
      const Vec6 F = dynamics::contact_wrench(record, record.time, moved(tool, h * d), twist_of(v + h * dv));
      e.push_back((F - F0 + h * (contact_stiffness(record, tool) * d + contact_damping(record) * dv)).norm());
    }
    EXPECT_NEAR(slope(hs, e), 2.0, 0.1) << run;
  }
  EXPECT_EQ(contact_stiffness({}, random_pose()).norm() + contact_damping({}).norm(), 0.0);
}

// Force is minus the gradient of the energy: F . d = -dE for every direction.
TEST_F(Coupling, spring_is_the_gradient_of_its_energy) {
  for (int run = 0; run < 5; ++run) {
    const Pose tool = random_pose(), handle{quaternion_of(random_vec()) * tool.rotation, random_vec()};
    const Vec6 F = coupling_wrench(kGains, {tool, {}}, {handle, {}});
    std::vector<double> hs, e;
    for (double h = 0.02; h > 5e-4; h /= 2) {
      Vec6 error;
      for (int i = 0; i < 6; ++i) {
        const Vec6 d = Vec6::Unit(i);
        error[i] = (coupling_energy(kGains, moved(tool, h * d), handle) -
                    coupling_energy(kGains, moved(tool, -h * d), handle)) /
                       (2 * h) +
                   F[i];
      }
      EXPECT_LT(error.tail<3>().norm(), 1e-9);  // quadratic
      hs.push_back(h);
      e.push_back(error.head<3>().norm());
    }
    EXPECT_NEAR(slope(hs, e), 2.0, 0.1) << run;
  }
}

// Power supplied at both ends = rate of the spring's energy + dissipation >= 0: the pair (wrench on tool,
// opposite on hand) is passive.
TEST_F(Coupling, passive_at_its_two_ends) {
  for (int run = 0; run < 100; ++run) {
    CouplingGains damper = kGains;
    damper.k = damper.k_r = 0.0;
    const RigidMotion tool{random_pose(), twist_of(random_vec6())},
        handle{random_pose(), twist_of(random_vec6())};
    const Vec6 F = coupling_wrench(damper, tool, handle);
    const double power_in = F.dot(stacked(handle.twist)) - F.dot(stacked(tool.twist));
    EXPECT_NEAR(power_in, coupling_dissipation(damper, tool.twist, handle.twist), 1e-13);
    EXPECT_GE(power_in, 0.0);
  }
}

TEST_F(Coupling, does_not_see_where_the_world_stands) {
  for (int run = 0; run < 20; ++run) {
    const RigidMotion tool{random_pose(), twist_of(random_vec6())},
        handle{random_pose(), twist_of(random_vec6())};
    const Pose world = random_pose();
    const auto rotated = [&](const RigidMotion& m) {
      return RigidMotion{world * m.pose, {world.rotation * m.twist.angular, world.rotation * m.twist.linear}};
    };
    const Vec6 F = coupling_wrench(kGains, tool, handle),
               G = coupling_wrench(kGains, rotated(tool), rotated(handle));
    EXPECT_LT((world.rotation * Vec3(F.head<3>()) - G.head<3>()).norm() +
                  (world.rotation * Vec3(F.tail<3>()) - G.tail<3>()).norm(),
              1e-11);
  }
}

// Path within a tick: pose and twist at the ends are met, the twist is the derivative of the pose, and the
// error is of fourth order for a smooth handle.
TEST_F(HandlePath, hermite_in_pose_and_twist) {
  const auto hand = [](double t) {
    const Vec3 theta = Vec3(std::sin(t), t * t, std::cos(2 * t)),
               rate = Vec3(std::cos(t), 2 * t, -2 * std::sin(2 * t));
    return RigidMotion{{quaternion_of(theta), Vec3(std::sin(3 * t), t, 0)},
                       {left_jacobian(theta) * rate, Vec3(3 * std::cos(3 * t), 1, 0)}};
  };
  const auto tick = [&](double t0, double h) {
    TickInput input;
    input.t0 = t0, input.h = h;
    input.handle = {hand(t0).pose, hand(t0 + h).pose, hand(t0).twist, hand(t0 + h).twist};
    return input;
  };
  std::vector<double> hs, e;
  for (double h = 0.2; h > 0.01; h /= 2) {
    const TickInput input = tick(0.3, h);
    for (double t : {0.3, 0.3 + h}) {
      EXPECT_LT(pose_difference(handle_at(input, t).pose, hand(t).pose).norm(), 1e-14);
      EXPECT_LT((stacked(handle_at(input, t).twist) - stacked(hand(t).twist)).norm(), 1e-12);
    }
    hs.push_back(h);
    e.push_back(pose_difference(handle_at(input, 0.3 + 0.4 * h).pose, hand(0.3 + 0.4 * h).pose).norm());
  }
  EXPECT_NEAR(slope(hs, e), 4.0, 0.3);
  const TickInput input = tick(0.3, 0.5);
  std::vector<double> steps, errors;
  for (double h = 0.02; h > 5e-4; h /= 2) {
    steps.push_back(h);
    errors.push_back(
        (pose_difference(handle_at(input, 0.5 - h).pose, handle_at(input, 0.5 + h).pose) / (2 * h) -
         stacked(handle_at(input, 0.5).twist))
            .norm());
  }
  EXPECT_NEAR(slope(steps, errors), 2.0, 0.1);
}
