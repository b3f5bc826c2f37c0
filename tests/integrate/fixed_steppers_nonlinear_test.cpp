#include <gtest/gtest.h>

#include "integrate/fixed_steppers.h"
#include "integrate/top.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/mesh/generators.h"

namespace palpate {
namespace {

using namespace fakes;
using hand_steppers::kNewton;

/// Corotational box of 20 nodes, clamped at one end unless free.
struct Box {
  TetMesh rest = mesh::box(Vec3(1.0, 0.25, 0.25), {4, 1, 1});
  VecX mass;
  State state;
  System system;

  explicit Box(bool clamped, double youngs_modulus = 1e5) {
    fem::Material m;
    m.youngs_modulus = youngs_modulus;
    m.poissons_ratio = 0.3;
    mass = fem::lumped_masses(rest, m.density).transpose().replicate(3, 1).reshaped();
    const VecX q0 = rest.nodes.reshaped();
    const int n = static_cast<int>(q0.size());
    const int id =
        state.insert(BlockSpec{.name = "box", .q_size = n, .u_size = n, .q_scale = 0.1, .u_scale = 1.0}, q0,
                     VecX::Zero(n));
    system.add(std::make_shared<fem::SoftBody>("box", rest, m, fem::SoftBodyOptions{}, id));
    system.add(fem::make_lumped_mass(rest, m.density, id));
    if (clamped) {
      const auto dofs = fem::dofs_of_nodes(
          fem::nodes_in_box(rest.nodes, Vec3(-0.5, -1, -1), Vec3(-0.4999, 1, 1)), 0, "xyz");
      system.add(fem::make_fixed(dofs, q0(dofs)));
    }
    system.prepare(state.view());
  }
  /// Sets a smooth initial velocity that bends it strongly: the tip moves by half the length.
  void swing(double speed) {
    for (int i = 0; i < rest.nodes.cols(); ++i) {
      const double s = rest.nodes(0, i) + 0.5;
      state.u().segment<3>(3 * i) = Vec3(0.0, speed * s * s, 0.5 * speed * s * s * s);
    }
  }
  void spin(const Vec3& w) {
    for (int i = 0; i < rest.nodes.cols(); ++i)
      state.u().segment<3>(3 * i) =
          w.cross(rest.nodes.col(i)) + 0.2 * Vec3(rest.nodes(1, i), rest.nodes(2, i), rest.nodes(0, i));
  }
  Vec3 angular_momentum() const {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < rest.nodes.cols(); ++i)
      sum += mass[3 * i] * state.q().segment<3>(3 * i).cross(state.u().segment<3>(3 * i));
    return sum;
  }
};

constexpr double kEnd = 0.16;

/// State (q, kEnd u) at kEnd.
VecX swung(const std::string& name, double step_or_rtol, bool rtol, StepperCounters* counters = nullptr,
           int kept = 1) {
  Box box(true);
  box.swing(3.0);
  IntegratorSpec s;
  s.name = name;
  s.factor_kept_steps = kept;
  (rtol ? s.rtol : s.step_s) = step_or_rtol;
  const auto stepper = integrate::make_stepper(box.system, box.state, s);
  const StepResult result = stepper->advance_to(kEnd);
  EXPECT_TRUE(result.ok()) << result.message;
  if (counters) *counters = stepper->counters();
  VecX y(2 * box.state.q().size());
  y << box.state.q(), kEnd * box.state.u();
  return y;
}

TEST(HandSteppersNonlinear, ConvergeOnABendingBodyAtTheirOrder) {
  // two families; at 1e-10, cvode-bdf is at its tightest tolerance
  const VecX reference = swung("cvode-bdf", 1e-10, true), start = Box(true).state.q();
  EXPECT_GT((reference.head(start.size()) - start).lpNorm<Eigen::Infinity>(), 0.3) << "it bends far";
  EXPECT_LT((reference - swung("ark-dirk-esdirk547", 1e-11, true)).norm(), 3e-9);
  for (const std::string name :
       {"linearly-implicit-euler", "linearly-implicit-bdf2", "backward-euler", "symplectic-euler",
        "implicit-midpoint", "bdf2", "newmark", "generalized-alpha", "rk4"}) {
    const int order = ladder_order(name);
    const std::vector<double> steps = order == 4   ? std::vector<double>{2e-3, 1e-3, 5e-4}
                                      : order == 2 ? std::vector<double>{1e-3, 5e-4, 2.5e-4}
                                                   : std::vector<double>{5e-4, 2.5e-4, 1.25e-4};
    std::vector<double> errors;
    for (const double h : steps) errors.push_back((swung(name, h, false) - reference).norm());
    EXPECT_NEAR(slope(steps, errors), order, 0.15) << name << ", finest error " << errors.back();
  }
}

TEST(HandSteppersNonlinear, KeepAFactorAndTheAnswer) {
  for (const std::string& name : kNewton) {
    StepperCounters full, kept;
    const VecX a = swung(name, 2e-3, false, &full), b = swung(name, 2e-3, false, &kept, 10);
    EXPECT_LT((a - b).lpNorm<Eigen::Infinity>(), 1e-8) << name << ": newton_rtol";
    EXPECT_LT(4 * kept.solver.factorisations, full.solver.factorisations) << name;
    EXPECT_EQ(kept.steps, 80);
    EXPECT_EQ(kept.newton_failures, 0);
    EXPECT_EQ(full.kept_matrix_iterations, 0);
    EXPECT_GT(kept.kept_matrix_iterations, kept.newton_iterations / 2) << name;
  }
}

// A large step that requires full Newton: the body is thrown by half its length in one step.
TEST(HandSteppersNonlinear, SolveALargeStep) {
  for (const std::string& name : kNewton)
    for (const int kept : {1, 10}) {
      StepperCounters counters;
      const VecX q = swung(name, 0.08, false, &counters, kept);
      EXPECT_TRUE(q.allFinite());
      EXPECT_GE(counters.steps, 2) << name;
    }
}

// The angular momentum of nodes is a quadratic invariant: Gauss' method conserves it to Newton's tolerance,
// and no other method here does.
TEST(ImplicitMidpoint, KeepsTheAngularMomentumOfASoftBody) {
  const auto drift = [](const std::string& name) {
    Box box(false);
    box.spin(Vec3(1.0, 2.0, 10.0));
    const Vec3 before = box.angular_momentum();
    IntegratorSpec s;
    s.name = name;
    s.step_s = 5e-3;
    s.newton_rtol = 1e-11;
    EXPECT_TRUE(integrate::make_stepper(box.system, box.state, s)->advance_to(1.0).ok());
    return (box.angular_momentum() - before).norm() / before.norm();
  };
  EXPECT_LT(drift("implicit-midpoint"), 1e-9);
  EXPECT_GT(drift("backward-euler"), 1e-3);
  EXPECT_GT(drift("newmark"), 1e-7);
}

/// Largest relative deviation of a free top's angular momentum from its initial value over a duration.
double top_drift(const std::string& name, double h, double duration) {
  Top top;
  IntegratorSpec s;
  s.name = name;
  s.step_s = h;
  const auto stepper = integrate::make_stepper(top.system, top.state, s);
  double worst = 0.0;
  for (double t = 0.1; t < duration + 1e-9; t += 0.1) {
    EXPECT_TRUE(stepper->advance_to(t).ok());
    const Vec3 L = inertia_in_world(top.state.view(), *top.body) * top.state.u(*top.body).head<3>();
    worst = std::max(worst, (L - top.L).norm() / top.L.norm());
  }
  return worst;
}

// R I R^T w is no quadratic function of quaternion and w: it deviates by O(h^2), but the method is symmetric
// and the free top reversible, so that there is no drift.
TEST(ImplicitMidpoint, KeepsTheAngularMomentumOfARigidBodyNearWithoutDrift) {
  std::vector<double> steps = {0.02, 0.01, 0.005}, errors;
  for (const double h : steps) errors.push_back(top_drift("implicit-midpoint", h, 3.0));
  EXPECT_NEAR(slope(steps, errors), 2.0, 0.15);
  EXPECT_LT(top_drift("implicit-midpoint", 0.02, 60.0), 1.5 * errors[0]) << "twenty times as long";
  EXPECT_GT(top_drift("rk4", 0.02, 60.0), 10.0 * top_drift("rk4", 0.02, 3.0)) << "not symmetric: it drifts";
}

}  // namespace
}  // namespace palpate
