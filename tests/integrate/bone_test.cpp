// Tissue around a free bone of a thousandth of its mass, with the integrators of the registry:
// conservation of momentum, and stability.
#include <gtest/gtest.h>

#include "fem/bone_in_tissue.h"
#include "integrate/fakes.h"

namespace palpate {
namespace {

using namespace fem::testing;

IntegratorSpec spec_of(const std::string& name, double step_s, double rtol = 1e-4) {
  IntegratorSpec s;
  s.name = name;
  s.step_s = step_s;
  s.rtol = rtol;
  return s;
}

void advance(BoneInTissue& b, const IntegratorSpec& spec, double t_end) {
  const auto stepper = integrate::make_stepper(b.system, b.state, spec);
  const dynamics::StepResult result = stepper->advance_to(t_end);
  ASSERT_TRUE(result.ok()) << spec.name << ": " << result.message;
  ASSERT_TRUE(b.state.q().allFinite() && b.state.u().allFinite()) << spec.name;
}

/// Tissue and bone thrown and spinning as one: relative changes of angular and linear momentum over 0.2 s.
std::pair<double, double> drift(const IntegratorSpec& spec) {
  BoneInTissue b({.damping = 1e-3});
  b.prepare();
  b.throw_rigidly(Vec3(0.3, 0.2, -0.1), Vec3(1.5, -4.0, 3.0));
  const Vec6 before = b.momentum();
  advance(b, spec, 0.2);
  const Vec6 change = b.momentum() - before;
  return {change.head<3>().norm() / before.head<3>().norm(),
          change.tail<3>().norm() / before.tail<3>().norm()};
}

// Carried nodes move on circles, which a step replaces by chords: momentum, which is conserved to rounding at
// every instant, is conserved over time to the method's order.
TEST(Bone, FixedStepsKeepMomentumToTheirOrder) {
  for (const char* name : {"linearly-implicit-euler", "backward-euler", "implicit-midpoint", "bdf2",
                           "newmark", "generalized-alpha"}) {
    const int order = find(integrate::stepper_registry(), name, "integrator").traits.order;
    // 10 ms does not resolve the tissue's modes
    std::vector<double> steps = {0.005, 0.0025, 0.00125}, angular, linear;
    for (const double h : steps) {
      const auto [dL, dP] = drift(spec_of(name, h));
      angular.push_back(dL);
      linear.push_back(dP);
    }
    EXPECT_LT(drift(spec_of(name, 0.01)).first, order == 1 ? 0.3 : 0.01) << name;
    EXPECT_GT(fakes::slope(steps, angular), order - 0.3) << name << ": " << angular[0] << ", " << angular[2];
    EXPECT_GT(fakes::slope(steps, linear), order - 0.3) << name << ": " << linear[0] << ", " << linear[2];
  }
}

TEST(Bone, ErrorControlKeepsMomentumToTheTolerance) {
  for (const char* name : {"cvode-bdf", "ida", "ark-dirk-esdirk436"}) {
    for (const double rtol : {1e-4, 1e-6}) {
      const auto [angular, linear] = drift(spec_of(name, 0.01, rtol));
      EXPECT_LT(angular, 100.0 * rtol) << name << ", rtol " << rtol;
      EXPECT_LT(linear, 100.0 * rtol) << name << ", rtol " << rtol;
    }
  }
}

// A bone that compresses its tissue is released at rest: the tissue's forces on its nodes are in equilibrium,
// and remain so under rotation, because they rotate with it. A step that holds them fixed while the arms
// rotate has a spurious moment, which grows with compressed tissue and makes the body spin up.
TEST(Bone, ALightBoneUnderPrestressDoesNotSpinUp) {
  double spin[2] = {0.0, 0.0};
  for (const bool included : {true, false}) {
    BoneInTissue b({.damping = 1e-3, .spread = 0.7, .geometric_stiffness = included});
    b.prepare();
    b.throw_rigidly(Vec3(0.1, 0.2, -0.1), Vec3::Zero());
    const double before = b.momentum().head<3>().norm();
    for (int i = 1; i <= 100; ++i) advance(b, spec_of("linearly-implicit-euler", 0.01), 0.01 * i);
    spin[included] = (b.momentum().head<3>().norm() - before);
  }
  EXPECT_LT(std::abs(spin[true]), 2e-4) << "kg m^2/s; the cube's inertia is 1.7e-3 kg m^2";
  EXPECT_GT(spin[false], 1e-2) << "what the geometric stiffness is there for";
}

// Linearly implicit Euler at 10 ms, with the bone's mass going to zero: the same motion without smaller
// steps.
TEST(Bone, ItsMassMayGoToNothing) {
  Vec6 last = Vec6::Zero();
  for (const double ratio : {1e-3, 1e-6, 1e-9}) {
    BoneInTissue b({.mass_ratio = ratio, .damping = 1e-3});
    b.prepare();
    b.disturb(0.002, 0.5, 5);
    advance(b, spec_of("linearly-implicit-euler", 0.01), 0.5);
    const auto& block = *b.state.layout().find(b.bone);
    const Vec6 u = b.state.u(block);
    if (ratio < 1e-3) { EXPECT_LT((u - last).norm(), 2e-2 * u.norm() + 1e-6) << ratio; }
    EXPECT_LT(u.norm(), 20.0);
    last = u;
  }
}

// With very stiff tissue, tissue and bone form one rigid body: they tumble as Euler's top with the moments of
// inertia of all masses together.
TEST(Bone, StiffTissueAndItsBoneTumbleAsOneRigidBody) {
  BoneInTissue b({.mass_ratio = 0.3, .youngs_modulus = 1e8, .damping = 1e-5});
  b.inertia = b.bone_mass * Vec3(1e-4, 1.5e-4, 2e-4);
  b.prepare();
  const auto& block = *b.state.layout().find(b.bone);
  const Vec3 w0(2.0, 6.0, -1.0);
  double mass = b.bone_mass;
  Vec3 centre = b.bone_mass * Vec3(b.state.q(block).tail<3>());
  for (int i = 0; i < b.masses.size(); ++i) {
    mass += b.masses[i];
    centre += b.masses[i] * b.state.view().position(i);
  }
  centre /= mass;
  const auto about_centre = [&](double m, const Vec3& x) -> Mat3 {
    return m * ((x - centre).squaredNorm() * Mat3::Identity() - (x - centre) * (x - centre).transpose());
  };
  Mat3 I = dynamics::world_inertia(dynamics::motion_of(b.state.view(), block).pose, b.inertia) +
           about_centre(b.bone_mass, b.state.q(block).tail<3>());
  for (int i = 0; i < b.masses.size(); ++i) I += about_centre(b.masses[i], b.state.view().position(i));
  b.throw_rigidly(-w0.cross(centre), w0);  // about the centre of mass, which is at rest
  const Quat start(b.state.q(block)[0], b.state.q(block)[1], b.state.q(block)[2], b.state.q(block)[3]);

  // Torque-free: L = I w0 is constant in space, w = R I^-1 R^T L, q' = 1/2 (0, w) q; integrated by the
  // classical fourth-order method with steps of 0.1 ms.
  const Vec3 L = I * w0;
  const Mat3 inverse = I.inverse();
  const double T = 0.6, h = 1e-4;
  Eigen::Vector4d r(1, 0, 0, 0);
  const auto rate = [&](const Eigen::Vector4d& q) {
    const Quat turn = Quat(q[0], q[1], q[2], q[3]);
    const Mat3 R = turn.normalized().toRotationMatrix();
    const Vec3 w = R * inverse * R.transpose() * L;
    const Quat d = Quat(0, w.x(), w.y(), w.z()) * turn;
    return Eigen::Vector4d(0.5 * Eigen::Vector4d(d.w(), d.x(), d.y(), d.z()));
  };
  for (int i = 0; i < std::lround(T / h); ++i) {
    const Eigen::Vector4d k1 = rate(r), k2 = rate(r + h / 2 * k1), k3 = rate(r + h / 2 * k2),
                          k4 = rate(r + h * k3);
    r = (r + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)).normalized();
  }
  // tolerances are in units of the tissue's wave speed, 316 m/s
  advance(b, spec_of("cvode-bdf", 0.01, 1e-8), T);
  const Quat now(b.state.q(block)[0], b.state.q(block)[1], b.state.q(block)[2], b.state.q(block)[3]);
  const double off = rotation_vector(now * (Quat(r[0], r[1], r[2], r[3]) * start).conjugate()).norm();
  EXPECT_GT(rotation_vector(Quat(r[0], r[1], r[2], r[3])).norm(), 2.0) << "it turned";
  EXPECT_LT(off, 2e-4);
}

}  // namespace
}  // namespace palpate
