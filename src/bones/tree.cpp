#include "bones/tree.h"

#include <algorithm>
#include <utility>

#include "bones/tree_impl.h"
#include "core/counters.h"
#include "core/so3.h"
#include "palpate/core/error.h"

namespace palpate::bones {
namespace {

SimTK::Vec3 to(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Vec3 from(const SimTK::Vec3& v) { return {v[0], v[1], v[2]}; }

SimTK::Transform to(const Pose& pose) {
  const Quat& r = pose.rotation;
  return {SimTK::Rotation(SimTK::Quaternion(r.w(), r.x(), r.y(), r.z())), to(pose.translation)};
}
Pose from(const SimTK::Transform& X) {
  const SimTK::Quaternion r = X.R().convertRotationToQuaternion();
  return {Quat(r[0], r[1], r[2], r[3]), from(X.p())};
}

void check(const TreeBone& bone, int index) {
  const std::string where = fmt::format("bone \"{}\"", bone.name);
  dynamics::check_inertia(bone.mass, bone.inertia, where.c_str());
  PALPATE_CHECK(bone.parent < index, "{}: its parent {} comes after it", where, bone.parent);
  if (bone.joint == JointType::kFree && bone.parent >= 0)
    fail("{}: a free joint is for a root, but this bone has a parent; use \"ball\", \"hinge\" or \"weld\"",
         where);
  if (bone.joint == JointType::kHinge && !(bone.axis.norm() > 0.0)) fail("{}: a hinge needs an axis", where);
  if (!(bone.stiffness >= 0.0 && bone.damping >= 0.0))
    fail("{}: stiffness {} and damping {} of its joint must not be negative", where, bone.stiffness,
         bone.damping);
}

/// Returns the frame of a joint at the start: a hinge rotates about its z axis.
Pose joint_frame(const TreeBone& bone) {
  if (bone.joint != JointType::kHinge) return {Quat::Identity(), bone.joint_position};
  return {Quat::FromTwoVectors(Vec3::UnitZ(), bone.axis.normalized()), bone.joint_position};
}

SimTK::MobilizedBody add(SimTK::MobilizedBody& parent, const Pose& parent_start, const TreeBone& bone) {
  const SimTK::Body::Rigid body(SimTK::MassProperties(
      bone.mass, SimTK::Vec3(0), SimTK::Inertia(bone.inertia.x(), bone.inertia.y(), bone.inertia.z())));
  if (bone.joint == JointType::kFree)
    return SimTK::MobilizedBody::Free(parent, SimTK::Transform(), body, SimTK::Transform());
  const Pose joint = joint_frame(bone);
  const SimTK::Transform on_parent = to(parent_start.inverse() * joint),
                         on_bone = to(bone.start.inverse() * joint);
  if (bone.joint == JointType::kHinge) return SimTK::MobilizedBody::Pin(parent, on_parent, body, on_bone);
  if (bone.joint == JointType::kBall) return SimTK::MobilizedBody::Ball(parent, on_parent, body, on_bone);
  return SimTK::MobilizedBody::Weld(parent, on_parent, body, on_bone);
}

constexpr int q_count(JointType joint) {
  return joint == JointType::kFree ? 7 : joint == JointType::kBall ? 4 : joint == JointType::kHinge ? 1 : 0;
}
constexpr int u_count(JointType joint) {
  return joint == JointType::kFree ? 6 : joint == JointType::kBall ? 3 : joint == JointType::kHinge ? 1 : 0;
}

/// Computes q' = N u joint by joint: the quaternion rate for quaternions, u itself for the other coordinates.
class TreeKinematics final : public dynamics::BlockKinematics {
 public:
  explicit TreeKinematics(const std::vector<TreeBone>& bones) {
    for (const TreeBone& bone : bones) joints_.push_back(bone.joint);
  }
  void q_dot(const dynamics::ConstSegment& q, const dynamics::ConstSegment& u,
             dynamics::Segment out) const override {
    each([&](JointType joint, int i, int j) {
      if (joint == JointType::kHinge) {
        out[i] = u[j];
        return;
      }
      const Quat rate = Quat(0.0, u[j], u[j + 1], u[j + 2]) * Quat(q[i], q[i + 1], q[i + 2], q[i + 3]);
      out[i] = 0.5 * rate.w();
      out.segment<3>(i + 1) = 0.5 * rate.vec();
      if (joint == JointType::kFree) out.segment<3>(i + 4) = u.segment<3>(j + 3);
    });
  }
  void u_of_q_dot(const dynamics::ConstSegment& q, const dynamics::ConstSegment& q_dot,
                  dynamics::Segment u) const override {
    each([&](JointType joint, int i, int j) {
      if (joint == JointType::kHinge) {
        u[j] = q_dot[i];
        return;
      }
      const Quat rotation(q[i], q[i + 1], q[i + 2], q[i + 3]),
          rate(q_dot[i], q_dot[i + 1], q_dot[i + 2], q_dot[i + 3]);
      u.segment<3>(j) = 2.0 * (rate * rotation.conjugate()).vec() / rotation.squaredNorm();
      if (joint == JointType::kFree) u.segment<3>(j + 3) = q_dot.segment<3>(i + 4);
    });
  }
  void project(dynamics::Segment q) const override {
    each([&](JointType joint, int i, int) {
      if (joint != JointType::kHinge) q.segment<4>(i).normalize();
    });
  }

 private:
  template <class Do>
  void each(const Do& act) const {
    int i = 0, j = 0;
    for (const JointType joint : joints_) {
      if (joint != JointType::kWeld) act(joint, i, j);
      i += q_count(joint);
      j += u_count(joint);
    }
  }
  std::vector<JointType> joints_;
};

}  // namespace

BoneTree::Impl::Impl(std::vector<TreeBone> bones_in, const Vec3& gravity_in)
    : bones(std::move(bones_in)), gravity(gravity_in), matter(system), forces(system) {
  PALPATE_CHECK(!bones.empty(), "a tree without bones");
  counters::count("tool.simbody_system");
  int q = 0, u = 0;
  for (int i = 0; i < static_cast<int>(bones.size()); ++i) {
    const TreeBone& bone = bones[static_cast<std::size_t>(i)];
    check(bone, i);
    SimTK::MobilizedBody& parent = bone.parent < 0 ? static_cast<SimTK::MobilizedBody&>(matter.Ground())
                                                   : bodies[static_cast<std::size_t>(bone.parent)];
    bodies.push_back(
        add(parent, bone.parent < 0 ? Pose{} : bones[static_cast<std::size_t>(bone.parent)].start, bone));
    first_q.push_back(q);
    first_u.push_back(u);
    q += q_count(bone.joint);
    u += u_count(bone.joint);
    for (int k = 0; k < u_count(bone.joint); ++k) bone_of_u.push_back(i);
  }
  q_size = q;
  u_size = u;
  if (!gravity.isZero(0.0)) SimTK::Force::UniformGravity(forces, matter, to(gravity));
  state = system.realizeTopology();
  system.realizeModel(state);
  PALPATE_CHECK(state.getNQ() == q_size && state.getNU() == u_size,
                "Simbody has {} q and {} u, the tree {} and {}", state.getNQ(), state.getNU(), q_size,
                u_size);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (q_count(bones[i].joint) > 0)
      PALPATE_CHECK(
          bodies[i].getFirstQIndex(state) == first_q[i] && bodies[i].getFirstUIndex(state) == first_u[i],
          "Simbody orders its coordinates differently");
  poses.resize(bones.size());
  twists.resize(bones.size());
}

void BoneTree::Impl::go_to(const VecX& q, const VecX& u) {
  PALPATE_CHECK(q.size() == q_size && u.size() == u_size, "a tree of {} q and {} u was given {} and {}",
                q_size, u_size, q.size(), u.size());
  if (at_q.size() == q.size() && at_q == q && at_u == u) return;
  SimTK::Vector& sq = state.updQ();
  SimTK::Vector& su = state.updU();
  for (int i = 0; i < q_size; ++i) sq[i] = q[i];
  // The quaternion of a trial state is a unit quaternion only approximately: its direction is used.
  for (std::size_t b = 0; b < bones.size(); ++b) {
    if (q_count(bones[b].joint) < 4) continue;
    const Eigen::Vector4d unit = q.segment<4>(first_q[b]).normalized();
    for (int k = 0; k < 4; ++k) sq[first_q[b] + k] = unit[k];
  }
  for (int i = 0; i < u_size; ++i) su[i] = u[i];
  system.realize(state, SimTK::Stage::Velocity);
  for (std::size_t b = 0; b < bones.size(); ++b) {
    poses[b] = from(bodies[b].getBodyTransform(state));
    const SimTK::SpatialVec v = bodies[b].getBodyVelocity(state);
    twists[b] = {from(v[0]), from(v[1])};
  }
  at_q = q;
  at_u = u;
  has_jacobian = has_bias = has_mass = false;
}

void BoneTree::Impl::need_jacobian() {
  if (std::exchange(has_jacobian, true)) return;
  matter.calcSystemJacobian(state, columns);
  J.resize(6 * static_cast<Eigen::Index>(bones.size()), u_size);
  for (std::size_t b = 0; b < bones.size(); ++b)
    for (int j = 0; j < u_size; ++j) {
      const SimTK::SpatialVec& column = columns(bodies[b].getMobilizedBodyIndex(), j);
      J.block<3, 1>(6 * static_cast<Eigen::Index>(b), j) = from(column[0]);
      J.block<3, 1>(6 * static_cast<Eigen::Index>(b) + 3, j) = from(column[1]);
    }
}

void BoneTree::Impl::need_bias() {
  if (std::exchange(has_bias, true)) return;
  matter.calcBiasForSystemJacobian(state, biases);
}

/// Returns the rotation vector of a ball joint since the start, in the parent's axes.
Vec3 BoneTree::Impl::ball_rotation(const VecX& q, std::size_t bone) const {
  const auto r = q.segment<4>(first_q[bone]);
  return rotation_vector(Quat(r[0], r[1], r[2], r[3]).normalized());
}

BoneTree::BoneTree(std::vector<TreeBone> bones, const Vec3& gravity)
    : impl_(std::make_unique<Impl>(std::move(bones), gravity)) {}
BoneTree::~BoneTree() = default;

int BoneTree::size() const { return static_cast<int>(impl_->bones.size()); }
const TreeBone& BoneTree::bone(int i) const { return impl_->bones[static_cast<std::size_t>(i)]; }
int BoneTree::q_size() const { return impl_->q_size; }
int BoneTree::u_size() const { return impl_->u_size; }

VecX BoneTree::start() const {
  VecX q = VecX::Zero(q_size());
  for (std::size_t b = 0; b < impl_->bones.size(); ++b) {
    const TreeBone& bone = impl_->bones[b];
    const auto at = impl_->first_q[b];
    if (bone.joint == JointType::kBall) q[at] = 1.0;
    if (bone.joint == JointType::kFree)
      q.segment<7>(at) << bone.start.rotation.w(), bone.start.rotation.vec(), bone.start.translation;
  }
  return q;
}

VecX BoneTree::rigid_start(const Vec3& velocity, const Vec3& angular_velocity, const Vec3& centre) const {
  VecX u = VecX::Zero(u_size());
  for (std::size_t b = 0; b < impl_->bones.size(); ++b)
    if (impl_->bones[b].joint == JointType::kFree)
      u.segment<6>(impl_->first_u[b]) << angular_velocity,
          velocity + angular_velocity.cross(impl_->bones[b].start.translation - centre);
  return u;
}

dynamics::BlockSpec BoneTree::block(std::string name, double length, double speed) const {
  dynamics::BlockSpec spec{std::move(name),
                           dynamics::BlockKind::kArticulated,
                           q_size(),
                           u_size(),
                           length,
                           speed,
                           std::make_shared<TreeKinematics>(impl_->bones)};
  // All coordinates are angles, except the position of a free root.
  spec.angles_q.assign(static_cast<std::size_t>(q_size()), 1);
  spec.angles_u.assign(static_cast<std::size_t>(u_size()), 1);
  for (std::size_t b = 0; b < impl_->bones.size(); ++b)
    if (impl_->bones[b].joint == JointType::kFree)
      for (int k = 0; k < 3; ++k)
        spec.angles_q[static_cast<std::size_t>(impl_->first_q[b] + 4 + k)] =
            spec.angles_u[static_cast<std::size_t>(impl_->first_u[b] + 3 + k)] = 0;
  return spec;
}

dynamics::RigidMotion BoneTree::motion(const VecX& q, const VecX& u, int bone) const {
  impl_->go_to(q, u);
  return {impl_->poses[static_cast<std::size_t>(bone)], impl_->twists[static_cast<std::size_t>(bone)]};
}

Eigen::Ref<const MatX> BoneTree::jacobian(const VecX& q, const VecX& u, int bone) const {
  impl_->go_to(q, u);
  impl_->need_jacobian();
  return impl_->J.middleRows(6 * bone, 6);
}

Vec6 BoneTree::bias(const VecX& q, const VecX& u, int bone) const {
  impl_->go_to(q, u);
  impl_->need_bias();
  const SimTK::SpatialVec& b =
      impl_->biases[impl_->bodies[static_cast<std::size_t>(bone)].getMobilizedBodyIndex()];
  Vec6 out;
  out << from(b[0]), from(b[1]);
  return out;
}

const MatX& BoneTree::mass(const VecX& q) const {
  Impl& i = *impl_;
  i.go_to(q, i.at_u.size() == i.u_size ? i.at_u : VecX(VecX::Zero(i.u_size)));
  if (!std::exchange(i.has_mass, true)) {
    i.matter.calcM(i.state, i.simbody_mass);
    i.M.resize(i.u_size, i.u_size);
    for (int r = 0; r < i.u_size; ++r)
      for (int c = 0; c < i.u_size; ++c) i.M(r, c) = i.simbody_mass(r, c);
  }
  return i.M;
}

// Inverse dynamics gives the residual M u' + C(q, u) - f_applied; at u' = 0 the right-hand side is its
// negative.
VecX BoneTree::force(const VecX& q, const VecX& u) const {
  Impl& i = *impl_;
  i.go_to(q, u);
  i.system.realize(i.state, SimTK::Stage::Dynamics);
  i.zero.resize(i.u_size);
  i.zero.setToZero();
  i.matter.calcResidualForceIgnoringConstraints(
      i.state, i.zero, i.system.getRigidBodyForces(i.state, SimTK::Stage::Dynamics), i.zero, i.residual);
  VecX f(i.u_size);
  for (int k = 0; k < i.u_size; ++k) f[k] = -i.residual[k];
  for (std::size_t b = 0; b < i.bones.size(); ++b) {
    const TreeBone& bone = i.bones[b];
    const auto at = i.first_u[b];
    if (bone.joint == JointType::kHinge) f[at] -= bone.stiffness * q[i.first_q[b]] + bone.damping * u[at];
    // The rotation vector is an eigenvector of its Jacobian: the moment of the energy k |theta|^2 / 2 is -k
    // theta.
    if (bone.joint == JointType::kBall)
      f.segment<3>(at) -= bone.stiffness * i.ball_rotation(q, b) + bone.damping * u.segment<3>(at);
  }
  return f;
}

void BoneTree::tangent(const VecX& q, double k_scale, double d_scale, MatX& A) const {
  Impl& i = *impl_;
  A.setZero(i.u_size, i.u_size);
  if (k_scale != 0.0 && !i.gravity.isZero(0.0)) {
    std::vector<ConstantForce> weights(i.bones.size());
    for (std::size_t b = 0; b < weights.size(); ++b) weights[b].force = i.bones[b].mass * i.gravity;
    add_geometric_stiffness(q, weights, A);
    A *= k_scale;
  }
  for (std::size_t b = 0; b < i.bones.size(); ++b) {
    const TreeBone& bone = i.bones[b];
    const auto at = i.first_u[b];
    if (bone.joint == JointType::kHinge) A(at, at) += k_scale * bone.stiffness + d_scale * bone.damping;
    if (bone.joint != JointType::kBall) continue;
    const Mat3 J = left_jacobian_inverse(i.ball_rotation(q, b));  // theta' = J^-1 u
    A.block<3, 3>(at, at) +=
        0.5 * k_scale * bone.stiffness * (J + J.transpose()) + d_scale * bone.damping * Mat3::Identity();
  }
}

double BoneTree::potential_energy(const VecX& q) const {
  Impl& i = *impl_;
  i.go_to(q, i.at_u.size() == i.u_size ? i.at_u : VecX(VecX::Zero(i.u_size)));
  double energy = 0.0;
  for (std::size_t b = 0; b < i.bones.size(); ++b) {
    const TreeBone& bone = i.bones[b];
    energy -= bone.mass * i.gravity.dot(i.poses[b].translation);
    if (bone.joint == JointType::kHinge) energy += 0.5 * bone.stiffness * q[i.first_q[b]] * q[i.first_q[b]];
    if (bone.joint == JointType::kBall) energy += 0.5 * bone.stiffness * i.ball_rotation(q, b).squaredNorm();
  }
  return energy;
}

double BoneTree::dissipated_power(const VecX& u) const {
  double power = 0.0;
  for (std::size_t b = 0; b < impl_->bones.size(); ++b) {
    const TreeBone& bone = impl_->bones[b];
    if (bone.joint == JointType::kHinge || bone.joint == JointType::kBall)
      power += bone.damping * u.segment(impl_->first_u[b], u_count(bone.joint)).squaredNorm();
  }
  return power;
}

}  // namespace palpate::bones
