#include "tool/rigid_block.h"

#include <gtest/gtest.h>

#include <random>

#include "palpate/dynamics/system.h"
#include "tool_fixtures.h"

using namespace palpate;
using namespace palpate::tool;
using namespace palpate::tool::testing;

namespace {

const Vec3 kInertia(3e-5, 4e-5, 5e-5);
constexpr double kMass = 0.1;

/// One rigid block in a State, at a pose and twist.
struct OneBody {
  dynamics::State state{16, 16};
  int id = -1;
  OneBody(const Pose& pose, const Twist& twist) {
    VecX q(7), u(6);
    q << pose.rotation.w(), pose.rotation.vec(), pose.translation;
    u << twist.angular, twist.linear;
    id = state.insert(rigid_block("tool", 0.01, 0.1), q, u);
  }
};

Pose random_pose(std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return {quaternion_of(Vec3(uniform(rng), uniform(rng), uniform(rng))),
          Vec3(uniform(rng), uniform(rng), uniform(rng))};
}

/// Remainder f(x + h d, u + h e) - f + h (K d + D e), fitted order over 6 halvings.
double taylor_order(dynamics::ForceTerm& term, OneBody& body, const Pose& pose, const Twist& twist,
                    const Vec6& d, const Vec6& e) {
  const auto at = [&](double h) {
    const Quat r = quaternion_of(h * d.head<3>()) * pose.rotation;
    body.state.q() << r.w(), r.vec(), pose.translation + h * d.tail<3>();
    body.state.u() << twist.angular + h * e.head<3>(), twist.linear + h * e.tail<3>();
    VecX f = VecX::Zero(6);
    term.add_force(body.state.view(), f);
    return f;
  };
  const VecX f0 = at(0.0);
  VecX linear = VecX::Zero(6);
  term.apply_tangent(body.state.view(), 1.0, 0.0, d, linear);
  term.apply_tangent(body.state.view(), 0.0, 1.0, e, linear);
  std::vector<double> hs, errors;
  for (double h = 0.02; h > 5e-4; h /= 2) {
    hs.push_back(h);
    errors.push_back((at(h) - f0 + h * linear).norm());
  }
  at(0.0);
  return slope(hs, errors);
}

HandlePath still(const Pose& pose) {
  return [pose](double) { return HandleState{pose, {}}; };
}

}  // namespace

TEST(RigidBlock, tangents_by_taylor) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int run = 0; run < 5; ++run) {
    const Pose pose = random_pose(rng);
    const Twist twist{5 * Vec3(uniform(rng), uniform(rng), uniform(rng)),
                      Vec3(uniform(rng), uniform(rng), uniform(rng))};
    OneBody body(pose, twist);
    const Vec6 d = Vec6::NullaryExpr([&] { return uniform(rng); }),
               e = Vec6::NullaryExpr([&] { return uniform(rng); });
    const auto gyroscopic = make_gyroscopic(body.id, kInertia, true);
    EXPECT_NEAR(taylor_order(*gyroscopic, body, pose, twist, d, e), 2.0, 0.1);
    const auto coupling =
        make_coupling_term(body.id, spec_for("linearly-implicit-euler"), still(random_pose(rng)));
    EXPECT_NEAR(taylor_order(*coupling, body, pose, twist, d, e), 2.0, 0.1);
  }
}

TEST(RigidBlock, assembled_and_applied_tangent_agree) {
  std::mt19937 rng(4);
  OneBody body(random_pose(rng), {Vec3(1, 2, 3), Vec3(4, 5, 6)});
  dynamics::System system;
  system.add(make_rigid_inertia(body.id, kMass, kInertia));
  system.add(make_gyroscopic(body.id, kInertia, true));
  system.add(make_coupling_term(body.id, spec_for("linearly-implicit-euler"), still({})));
  system.prepare(body.state.view());
  EXPECT_FALSE(system.symmetric());
  dynamics::BorderedMatrix A;
  system.step_matrix(body.state.view(), 2.0, 0.3, 0.05, A);
  const VecX x = VecX::LinSpaced(6, -1.0, 2.0);
  VecX y, mass;
  A.multiply(x, y);
  VecX expected = VecX::Zero(6);
  system.apply_mass(body.state.view(), x, mass);
  expected = 2.0 * mass;
  for (const auto& term : system.terms()) term->apply_tangent(body.state.view(), 0.05, 0.3, x, expected);
  EXPECT_LT((y - expected).norm(), 1e-13 * expected.norm());
}

TEST(RigidBlock, symmetric_coupling_is_symmetric) {
  std::mt19937 rng(6);
  OneBody body(random_pose(rng), {});
  const auto term = make_coupling_term(body.id, spec_for("linearly-implicit-euler"), still({}), true);
  EXPECT_TRUE(term->traits().symmetric_tangent);
  MatX A(6, 6);
  for (int i = 0; i < 6; ++i) {
    VecX column = VecX::Zero(6);
    term->apply_tangent(body.state.view(), 1.0, 0.5, VecX::Unit(6, i), column);
    A.col(i) = column;
  }
  EXPECT_LT((A - A.transpose()).norm(), 1e-14 * A.norm());
}

// One body in Simbody and in the System: the same right-hand side, observed over a tick of vanishing length.
TEST(RigidBlock, accelerates_as_the_simbody_tool_does) {
  std::mt19937 rng(8);
  for (int run = 0; run < 10; ++run) {
    const Pose pose = random_pose(rng), handle = random_pose(rng);
    const Twist twist{Vec3(20, -10, 5), Vec3(0.1, 0.2, 0.3)};
    const Vec3 gravity(0, 0, -9.81);
    ToolSpec spec = spec_for("semi-implicit-euler");
    spec.gravity = true;
    Tool tool(spec, gravity);
    tool.set_state(0.0, pose, twist);
    // semi-implicit: (u1 - u0)/h is the initial acceleration, up to h times the gyroscopic rate
    const double h = 1e-8;
    ASSERT_TRUE(tool.advance(h, held(handle), {}).ok());

    OneBody body(pose, twist);
    dynamics::System system;
    system.add(make_rigid_inertia(body.id, kMass, kInertia));
    system.add(make_gyroscopic(body.id, kInertia));
    system.add(make_rigid_weight(body.id, kMass, gravity));
    system.add(make_coupling_term(body.id, spec, still(handle)));
    system.prepare(body.state.view());
    VecX a;
    system.acceleration(body.state.view(), a);
    Vec6 expected;
    expected << (tool.twist().angular - twist.angular) / h, (tool.twist().linear - twist.linear) / h;
    EXPECT_LT((a - expected).norm(), 1e-6 * a.norm());
    EXPECT_NEAR(
        system.kinetic_energy(body.state.view()),
        [&] {
          tool.set_state(0, pose, twist);
          return tool.kinetic_energy();
        }(),
        1e-15);
  }
}

// A torque-free top in the System (classical Runge-Kutta on q' = N u, u' = a): energy and angular momentum
// are conserved to the method's order, 4.
TEST(RigidBlock, a_free_top_keeps_energy_and_angular_momentum) {
  const auto drift = [](double h) {
    OneBody body({quaternion_of(Vec3(0.3, 0.2, 0.1)), Vec3::Zero()}, {Vec3(2, 30, 1), Vec3::Zero()});
    dynamics::System system;
    system.add(make_rigid_inertia(body.id, kMass, kInertia));
    system.add(make_gyroscopic(body.id, kInertia));
    system.prepare(body.state.view());
    const auto rate = [&](const VecX& y) {
      const auto view = body.state.view(0.0, y.data(), y.data() + 7);
      VecX a, out(13);
      system.acceleration(view, a);
      dynamics::q_dot(body.state.layout(), y.data(), y.data() + 7, out.data());
      out.tail(6) = a;
      return out;
    };
    const auto invariants = [&](const VecX& y) {
      const auto view = body.state.view(0.0, y.data(), y.data() + 7);
      VecX L, out(4);
      system.apply_mass(view, y.tail(6), L);
      out << L.head<3>(), 0.5 * L.dot(y.tail(6));
      return out;
    };
    VecX y(13);
    y << body.state.q(), body.state.u();
    const VecX before = invariants(y);
    for (int i = 0; i < std::lround(0.5 / h); ++i) {
      const VecX k1 = rate(y), k2 = rate(y + h / 2 * k1), k3 = rate(y + h / 2 * k2), k4 = rate(y + h * k3);
      y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      dynamics::project(body.state.layout(), y.data());
    }
    const VecX after = invariants(y);
    return std::max((after - before).head<3>().norm() / before.head<3>().norm(),
                    std::abs(after[3] / before[3] - 1.0));
  };
  std::vector<double> hs = {4e-3, 2e-3, 1e-3}, e;
  for (double h : hs) e.push_back(drift(h));
  EXPECT_GT(slope(hs, e), 3.8);
  EXPECT_LT(e.back(), 1e-6);
}

TEST(RigidBlock, bad_bodies_are_refused) {
  EXPECT_THROW(make_rigid_inertia(0, 0.0, kInertia), Error);
  EXPECT_THROW(make_rigid_inertia(0, 1.0, Vec3(1, 1, 3)), Error);
  EXPECT_THROW(make_gyroscopic(0, Vec3(1, -1, 1)), Error);
  EXPECT_THROW(rigid_block("tool", 0.0, 1.0), InternalError);
}
