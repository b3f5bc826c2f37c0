#include "bones/tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "palpate/core/error.h"

using namespace palpate;
using namespace palpate::bones;

namespace {

const Vec3 kGravity(0.5, -2.0, -9.81);

TreeBone bone_at(const std::string& name, int parent, JointType joint, const Vec3& joint_position,
                 const Vec3& middle) {
  TreeBone b;
  b.name = name;
  b.parent = parent;
  b.joint = joint;
  b.joint_position = joint_position;
  b.start = {quaternion_of(Vec3(0.3, -0.2, 0.5) * (parent + 2)), middle};
  b.mass = 0.4 + 0.1 * (parent + 1);
  b.inertia = Vec3(2e-3, 3e-3, 1.5e-3);
  return b;
}

/// Tree with every joint type: a free root; a ball joint on it; on that a hinge that carries a weld, and a
/// second ball joint.
std::vector<TreeBone> limbs() {
  std::vector<TreeBone> bones;
  bones.push_back(bone_at("root", -1, JointType::kFree, Vec3::Zero(), Vec3(0.1, 0.2, 0.3)));
  bones.push_back(bone_at("upper", 0, JointType::kBall, Vec3(0.2, 0.2, 0.3), Vec3(0.3, 0.25, 0.3)));
  bones.push_back(bone_at("lower", 1, JointType::kHinge, Vec3(0.4, 0.3, 0.3), Vec3(0.5, 0.3, 0.2)));
  bones.push_back(bone_at("tip", 2, JointType::kWeld, Vec3(0.6, 0.3, 0.1), Vec3(0.65, 0.3, 0.1)));
  bones.push_back(bone_at("side", 1, JointType::kBall, Vec3(0.35, 0.2, 0.3), Vec3(0.35, 0.1, 0.35)));
  bones[2].axis = Vec3(0.2, 1.0, -0.3);
  bones[2].stiffness = 0.7;
  bones[2].damping = 0.03;
  bones[1].stiffness = 1.3;
  bones[4].damping = 0.02;
  return bones;
}

/// Random coordinates, and finite steps along u from them.
struct Coordinates {
  const BoneTree& tree;
  dynamics::BlockSpec block;
  VecX q, u;

  Coordinates(const BoneTree& tree_in, unsigned seed)
      : tree(tree_in), block(tree_in.block("tree", 0.5, 2.0)), q(tree_in.start()), u(tree_in.u_size()) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (double& x : u) x = uniform(rng);
    VecX displacement = u;
    for (double& x : displacement) x = 0.8 * uniform(rng);
    for (int i = 0; i < 20; ++i) q = moved(q, displacement / 20.0);
  }
  /// Returns q after a displacement d, integrated by one step of the midpoint rule; accurate enough for small
  /// d.
  VecX moved(const VecX& from, const VecX& d) const {
    VecX rate(q.size()), half = from, out = from;
    block.kinematics->q_dot(half, d, rate);
    half += 0.5 * rate;
    block.kinematics->q_dot(half, d, rate);
    out += rate;
    block.kinematics->project(out);
    return out;
  }
};

/// Central difference of g along a displacement d.
template <class G>
auto slope(const Coordinates& at, const VecX& d, const G& g, double e = 1e-5) {
  return ((g(at.moved(at.q, e * d)) - g(at.moved(at.q, -e * d))) / (2.0 * e)).eval();
}

}  // namespace

TEST(BoneTree, OneFreeBoneIsTheRigidBodyOfTheClosedForm) {
  const BoneTree tree({bone_at("one", -1, JointType::kFree, Vec3::Zero(), Vec3(0.1, 0.2, 0.3))}, kGravity);
  const Coordinates at(tree, 3);
  ASSERT_EQ(tree.u_size(), 6);
  const TreeBone& b = tree.bone(0);
  const dynamics::RigidMotion m = tree.motion(at.q, at.u, 0);
  const Mat3 I = dynamics::world_inertia(m.pose, b.inertia);
  Mat6 M = Mat6::Zero();
  M.topLeftCorner<3, 3>() = I;
  M.bottomRightCorner<3, 3>().diagonal().setConstant(b.mass);
  EXPECT_LT((tree.mass(at.q) - M).norm(), 1e-14);
  Vec6 f;
  const Vec3 w = at.u.head<3>();
  f << -w.cross(Vec3(I * w)), b.mass * kGravity;
  EXPECT_LT((tree.force(at.q, at.u) - f).norm(), 1e-13);
  EXPECT_LT((m.pose.translation - at.q.tail<3>()).norm(), 1e-15);
}

// Double pendulum in a plane, x to the side and z up: two rods on hinges about y. With angles a, b of the
// rods from straight down (both absolute), length L of the first rod, distance d of a centre of mass from its
// joint, and I about the centre of mass, the Lagrangian gives
//   M_aa = I1 + m1 d^2 + m2 L^2,  M_ab = m2 L d cos(a - b),  M_bb = I2 + m2 d^2,
//   Q_a = -(m1 d + m2 L) g sin a - m2 L d sin(a - b) b'^2,   Q_b = -m2 d g sin b + m2 L d sin(a - b) a'^2.
// The tree's second coordinate is b - a, so u = (a', b' - a') and
//   (a', b') = T u,   T = [1 0; 1 1],   M_tree = T^T M T,   f_tree = T^T Q.
TEST(BoneTree, ADoublePendulumHasLagrangesEquations) {
  constexpr double kLength = 0.4, d = 0.25, g = 9.81;
  std::vector<TreeBone> rods(2);
  for (int i = 0; i < 2; ++i) {
    TreeBone& rod = rods[static_cast<std::size_t>(i)];
    rod.name = i == 0 ? "upper" : "lower";
    rod.parent = i - 1;
    rod.joint = JointType::kHinge;
    rod.axis = -Vec3::UnitY();  // a positive rotation takes -z towards +x
    rod.joint_position = Vec3(0.0, 0.0, -kLength * i);
    rod.start.translation = rod.joint_position - Vec3(0.0, 0.0, d);
    rod.mass = 0.5 + 0.3 * i;
    rod.inertia = Vec3(4e-3, 5e-3, 3e-3);
  }
  const BoneTree tree(rods, Vec3(0, 0, -g));
  ASSERT_EQ(tree.u_size(), 2);
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  const double m1 = rods[0].mass, m2 = rods[1].mass, I = 5e-3;
  for (int run = 0; run < 20; ++run) {
    const double a = uniform(rng), b = uniform(rng), va = uniform(rng), vb = uniform(rng);
    Eigen::Matrix2d M, T;
    M << I + m1 * d * d + m2 * kLength * kLength, m2 * kLength * d * std::cos(a - b),
        m2 * kLength * d * std::cos(a - b), I + m2 * d * d;
    T << 1, 0, 1, 1;
    const Eigen::Vector2d Q(
        -(m1 * d + m2 * kLength) * g * std::sin(a) - m2 * kLength * d * std::sin(a - b) * vb * vb,
        -m2 * d * g * std::sin(b) + m2 * kLength * d * std::sin(a - b) * va * va);
    const VecX q = Eigen::Vector2d(a, b - a), u = Eigen::Vector2d(va, vb - va);
    EXPECT_LT((tree.mass(q) - T.transpose() * M * T).norm(), 1e-13);
    EXPECT_LT((tree.force(q, u) - T.transpose() * Q).norm(), 1e-12);
  }
}

TEST(BoneTree, VelocitiesAndAccelerationsAreTheDerivativesOfPositions) {
  const BoneTree tree(limbs(), kGravity);
  ASSERT_EQ(tree.u_size(), 13);
  ASSERT_EQ(tree.q_size(), 7 + 4 + 1 + 4);
  const Coordinates at(tree, 7);
  const Vec3 arm(0.1, -0.05, 0.2);
  for (int b = 0; b < tree.size(); ++b) {
    const auto point = [&](const VecX& q) -> Vec3 { return tree.motion(q, at.u, b).pose * arm; };
    const auto velocity = [&](const VecX& q) -> Vec3 {
      const dynamics::RigidMotion m = tree.motion(q, at.u, b);
      return m.twist.at(m.pose.rotation * arm);
    };
    const dynamics::RigidMotion m = tree.motion(at.q, at.u, b);
    const Vec3 r = m.pose.rotation * arm, w = m.twist.angular;
    EXPECT_LT((slope(at, at.u, point) - velocity(at.q)).norm(), 1e-9) << b;
    const Vec6 along = tree.jacobian(at.q, at.u, b) * at.u, bias = tree.bias(at.q, at.u, b);
    EXPECT_LT((along.head<3>() - w).norm() + (along.tail<3>() - m.twist.linear).norm(), 1e-13) << b;
    const Vec3 acceleration = bias.tail<3>() + bias.head<3>().cross(r) + w.cross(w.cross(r));
    EXPECT_LT((slope(at, at.u, velocity) - acceleration).norm(), 1e-8) << b;
  }
}

TEST(BoneTree, ItsJointsNeverComeApart) {
  const BoneTree tree(limbs(), kGravity);
  const Coordinates at(tree, 9);
  for (int b = 1; b < tree.size(); ++b) {
    const TreeBone &bone = tree.bone(b), &parent = tree.bone(bone.parent);
    const Vec3 on_bone = tree.motion(at.q, at.u, b).pose * (bone.start.inverse() * bone.joint_position);
    const Vec3 on_parent =
        tree.motion(at.q, at.u, bone.parent).pose * (parent.start.inverse() * bone.joint_position);
    EXPECT_LT((on_bone - on_parent).norm(), 1e-15) << bone.name;
  }
  for (int b = 0; b < tree.size(); ++b) {
    const Pose start = tree.motion(tree.start(), VecX::Zero(tree.u_size()), b).pose;
    EXPECT_LT(pose_difference(start, tree.bone(b).start).norm(), 1e-14)
        << "at the start it stands where it was put";
  }
}

// Energy balance: d/dt (u M u / 2 + V) = -P along M u' = f, with P the power dissipated by the dampers.
TEST(BoneTree, WhatItLosesIsWhatItsDampersTake) {
  const BoneTree tree(limbs(), kGravity);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Coordinates at(tree, seed);
    const double power = at.u.dot(tree.force(at.q, at.u));
    const auto energy = [&](const VecX& q) {
      return Eigen::Matrix<double, 1, 1>(0.5 * at.u.dot(tree.mass(q) * at.u) + tree.potential_energy(q));
    };
    EXPECT_NEAR(power + slope(at, at.u, energy)[0], -tree.dissipated_power(at.u), 1e-7) << seed;
    EXPECT_GT(tree.dissipated_power(at.u), 0.0);
  }
}

TEST(BoneTree, HeldForcesStiffenItAsTheirDerivativeSays) {
  const BoneTree tree(limbs(), Vec3::Zero());
  const Coordinates at(tree, 21);
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto random = [&] { return Vec3(uniform(rng), uniform(rng), uniform(rng)); };
  struct Pull {
    int bone;
    Vec3 local, force;
  };
  std::vector<Pull> pulls;
  for (int b = 0; b < tree.size(); ++b)
    for (int i = 0; i < 3; ++i) pulls.push_back({b, random(), random()});
  const auto generalised = [&](const VecX& q) {
    VecX Q = VecX::Zero(tree.u_size());
    for (const Pull& p : pulls) {
      Vec6 wrench;
      wrench << (tree.motion(q, at.u, p.bone).pose.rotation * p.local).cross(p.force), p.force;
      Q += tree.jacobian(q, at.u, p.bone).transpose() * wrench;
    }
    return Q;
  };
  std::vector<ConstantForce> held(static_cast<std::size_t>(tree.size()));
  for (const Pull& p : pulls) {
    held[static_cast<std::size_t>(p.bone)].force += p.force;
    held[static_cast<std::size_t>(p.bone)].moment +=
        (tree.motion(at.q, at.u, p.bone).pose.rotation * p.local) * p.force.transpose();
  }
  MatX K = MatX::Zero(tree.u_size(), tree.u_size());
  tree.add_geometric_stiffness(at.q, held, K);
  for (int j = 0; j < tree.u_size(); ++j) {
    const VecX column = -slope(at, VecX::Unit(tree.u_size(), j), generalised);
    EXPECT_LT((K.col(j) - column).norm(), 1e-8) << "direction " << j;
  }
}

TEST(BoneTree, TheTangentIsTheDerivativeAtRest) {
  std::vector<TreeBone> bones = limbs();
  bones[1].joint =
      JointType::kHinge;  // only the symmetric part of a ball's spring enters the tangent: see below
  const BoneTree tree(bones, kGravity);
  const Coordinates at(tree, 4);
  const VecX still = VecX::Zero(tree.u_size());
  MatX K, D;
  tree.tangent(at.q, 1.0, 0.0, K);
  tree.tangent(at.q, 0.0, 1.0, D);
  for (int j = 0; j < tree.u_size(); ++j) {
    const VecX unit = VecX::Unit(tree.u_size(), j);
    EXPECT_LT((K.col(j) + slope(at, unit, [&](const VecX& q) { return tree.force(q, still); })).norm(), 1e-7)
        << j;
    EXPECT_LT((D.col(j) + (tree.force(at.q, 1e-4 * unit) - tree.force(at.q, -1e-4 * unit)) / 2e-4).norm(),
              1e-9)
        << j;
  }
  const BoneTree balls(limbs(), Vec3::Zero());
  const Coordinates there(balls, 6);
  balls.tangent(there.q, 1.0, 0.0, K);
  const Mat3 ball = K.block<3, 3>(6, 6);
  EXPECT_LT((ball - ball.transpose()).norm(), 1e-15);
  Mat3 numeric;
  for (int j = 0; j < 3; ++j)
    numeric.col(j) = -slope(there, VecX::Unit(balls.u_size(), 6 + j), [&](const VecX& q) {
                        return balls.force(q, VecX::Zero(balls.u_size()));
                      }).segment<3>(6);
  EXPECT_LT((ball - 0.5 * (numeric + numeric.transpose())).norm(), 1e-8);
}

TEST(BoneTree, ItsKinematicsHaveALeftInverse) {
  const BoneTree tree(limbs(), kGravity);
  const Coordinates at(tree, 12);
  VecX rate(tree.q_size()), u(tree.u_size());
  at.block.kinematics->q_dot(at.q, at.u, rate);
  at.block.kinematics->u_of_q_dot(at.q, rate, u);
  EXPECT_LT((u - at.u).norm(), 1e-14);
}

// In other length units, the tolerances of the root's position scale with the length; those of angles do not.
TEST(BoneTree, KnowsItsAnglesFromItsLengths) {
  std::vector<TreeBone> bones{
      bone_at("root", -1, JointType::kFree, Vec3::Zero(), Vec3::Zero()),
      bone_at("hinge", 0, JointType::kHinge, Vec3(0.1, 0.0, 0.0), Vec3(0.2, 0.0, 0.0)),
      bone_at("ball", 1, JointType::kBall, Vec3(0.3, 0.0, 0.0), Vec3(0.4, 0.0, 0.0))};
  const dynamics::BlockSpec block = BoneTree(bones, kGravity).block("limb", 300.0, 5.0);
  EXPECT_EQ(block.q_scale, 300.0);
  EXPECT_EQ(block.u_scale, 5.0);
  EXPECT_EQ(block.angles_q, (std::vector<char>{1, 1, 1, 1, 0, 0, 0, 1, 1, 1, 1, 1}));
  EXPECT_EQ(block.angles_u, (std::vector<char>{1, 1, 1, 0, 0, 0, 1, 1, 1, 1}));
}

TEST(BoneTree, RefusesWhatIsNoTree) {
  const auto message = [](std::vector<TreeBone> bones) -> std::string {
    try {
      BoneTree tree(std::move(bones), Vec3::Zero());
    } catch (const Error& e) { return e.what(); }
    return "accepted";
  };
  std::vector<TreeBone> bones = limbs();
  bones[1].joint = JointType::kFree;
  EXPECT_NE(message(bones).find("bone \"upper\": a free joint is for a root"), std::string::npos)
      << message(bones);
  bones = limbs();
  bones[2].axis.setZero();
  EXPECT_NE(message(bones).find("bone \"lower\": a hinge needs an axis"), std::string::npos);
  bones = limbs();
  bones[4].damping = -1.0;
  EXPECT_NE(message(bones).find("must not be negative"), std::string::npos);
  bones = limbs();
  bones[3].inertia = Vec3(1.0, 1.0, 3.0);
  EXPECT_NE(message(bones), "accepted");
}
