#include "palpate/dynamics/rigid_body.h"

#include <cmath>

#include "palpate/core/error.h"

namespace palpate::dynamics {
namespace {

class RigidInertia : public InertiaTerm {
 public:
  RigidInertia(int block_id, double mass, const Vec3& inertia)
      : block_id_(block_id), mass_(mass), inertia_(inertia) {
    check_inertia(mass, inertia, "rigid body");
  }
  int block_id() const override { return block_id_; }
  bool diagonal() const override { return false; }
  void add_mass(const StateView& state, double scale, BorderedMatrix& A) const override {
    const auto& block = rigid_block_of(state, block_id_);
    const int at = block.u_offset - state.layout->nodal_size;
    A.corner.block<3, 3>(at, at) += scale * world_inertia(motion_of(state, block).pose, inertia_);
    A.corner.diagonal().segment<3>(at + 3).array() += scale * mass_;
  }
  void apply(const StateView& state, const VecX& x, VecX& y) const override {
    const auto& block = rigid_block_of(state, block_id_);
    y.segment<3>(block.u_offset) +=
        world_inertia(motion_of(state, block).pose, inertia_) * x.segment<3>(block.u_offset);
    y.segment<3>(block.u_offset + 3) += mass_ * x.segment<3>(block.u_offset + 3);
  }

 private:
  int block_id_;
  double mass_;
  Vec3 inertia_;
};

class Gyroscopic : public RigidForce {
 public:
  Gyroscopic(int block_id, const Vec3& inertia, bool tangent)
      : RigidForce(block_id), inertia_(inertia), tangent_(tangent) {
    check_inertia(1.0, inertia, "rigid body");
  }
  std::string_view name() const override { return "gyroscopic"; }
  TermTraits traits() const override {
    return {.stiff = false, .symmetric_tangent = !tangent_, .has_tangent = tangent_};
  }
  Vec6 force(double, const RigidMotion& m) const override {
    Vec6 f = Vec6::Zero();
    f.head<3>() = -m.twist.angular.cross(world_inertia(m.pose, inertia_) * m.twist.angular);
    return f;
  }
  Mat6 tangent(double, const RigidMotion& m, double k_scale, double d_scale) const override {
    return tangent_ ? gyroscopic_tangent(m, inertia_, k_scale, d_scale) : Mat6(Mat6::Zero());
  }

 private:
  Vec3 inertia_;
  bool tangent_;
};

class Weight : public RigidForce {
 public:
  Weight(int block_id, double mass, const Vec3& gravity) : RigidForce(block_id), weight_(mass * gravity) {}
  std::string_view name() const override { return "rigid weight"; }
  TermTraits traits() const override { return {.stiff = false, .conservative = true}; }
  Vec6 force(double, const RigidMotion&) const override {
    Vec6 f = Vec6::Zero();
    f.tail<3>() = weight_;
    return f;
  }
  Mat6 tangent(double, const RigidMotion&, double, double) const override { return Mat6::Zero(); }
  double energy(const StateView& state) override { return -weight_.dot(motion(state).pose.translation); }

 private:
  Vec3 weight_;
};

}  // namespace

// I1 = int (y^2 + z^2) dm and so on: no principal moment can exceed the sum of the other two.
void check_inertia(double mass, const Vec3& inertia, const char* where) {
  if (!(mass > 0.0) || !std::isfinite(mass)) fail("{}: mass_kg = {} must be positive", where, mass);
  const double largest = inertia.maxCoeff();
  if (!inertia.allFinite() || !(inertia.minCoeff() > 0.0))
    fail(
        "{}: inertia_kg_m2 = [{}, {}, {}] must have three positive entries, or three zeros for those of a "
        "solid sphere",
        where, inertia.x(), inertia.y(), inertia.z());
  if (largest > (inertia.sum() - largest) * (1.0 + 1e-9))
    fail(
        "{}: inertia_kg_m2 = [{}, {}, {}] is impossible: each moment must be at most the sum of the other "
        "two",
        where, inertia.x(), inertia.y(), inertia.z());
}

BlockSpec rigid_block(std::string name, double length, double speed) {
  PALPATE_CHECK(length > 0.0 && speed > 0.0, "scales of rigid block \"{}\" must be positive: {} m, {} m/s",
                name, length, speed);
  return {std::move(name),       BlockKind::kRigidBody, 7, 6, length, speed, free_body_kinematics(),
          {1, 1, 1, 1, 0, 0, 0}, {1, 1, 1, 0, 0, 0}};
}

std::shared_ptr<InertiaTerm> make_rigid_inertia(int block_id, double mass, const Vec3& inertia) {
  return std::make_shared<RigidInertia>(block_id, mass, inertia);
}
std::shared_ptr<ForceTerm> make_gyroscopic(int block_id, const Vec3& inertia, bool tangent) {
  return std::make_shared<Gyroscopic>(block_id, inertia, tangent);
}
std::shared_ptr<ForceTerm> make_rigid_weight(int block_id, double mass, const Vec3& gravity) {
  return std::make_shared<Weight>(block_id, mass, gravity);
}

}  // namespace palpate::dynamics
