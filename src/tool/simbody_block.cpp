#include "tool/simbody_block.h"

#include <cmath>

#include "simbody_body.h"

namespace palpate::tool {
namespace {

using dynamics::gyroscopic_tangent;
using dynamics::motion_of;
using dynamics::rigid_block_of;
using dynamics::RigidForce;
using dynamics::StateView;

/// M(q) from Simbody, rows and columns in the order of u: the mobilizer's (angular, linear) in world axes
/// equals the block's.
class SimbodyInertia : public dynamics::InertiaTerm {
 public:
  SimbodyInertia(int block_id, std::shared_ptr<SimbodyBody> body)
      : block_id_(block_id), body_(std::move(body)) {}
  int block_id() const override { return block_id_; }
  bool diagonal() const override { return false; }
  void add_mass(const StateView& state, double scale, dynamics::BorderedMatrix& A) const override {
    const auto& block = rigid_block_of(state, block_id_);
    const int at = block.u_offset - state.layout->nodal_size;
    A.corner.block<6, 6>(at, at) += scale * body_->calc_mass(motion_of(state, block));
  }
  void apply(const StateView& state, const VecX& x, VecX& y) const override {
    const auto& block = rigid_block_of(state, block_id_);
    y.segment<6>(block.u_offset) += body_->calc_mass(motion_of(state, block)) * x.segment<6>(block.u_offset);
  }

 private:
  int block_id_;
  std::shared_ptr<SimbodyBody> body_;
};

/// Right-hand side f of M u' = f by Simbody, without coupling and contact, which are separate force terms.
/// Simbody provides no derivatives: the weight is constant, and the tangent of a single body's gyroscopic
/// force is known in closed form.
class SimbodyForce : public RigidForce {
 public:
  SimbodyForce(int block_id, std::shared_ptr<SimbodyBody> body)
      : RigidForce(block_id), body_(std::move(body)) {}
  std::string_view name() const override { return "tool (Simbody)"; }
  dynamics::TermTraits traits() const override {
    return {.stiff = false, .fast = true, .symmetric_tangent = false, .conservative = true};
  }
  Vec6 force(double t, const RigidMotion& motion) const override { return body_->calc_force(t, motion); }
  Mat6 tangent(double, const RigidMotion& motion, double k_scale, double d_scale) const override {
    return gyroscopic_tangent(motion, body_->parameters().inertia, k_scale, d_scale);
  }
  double energy(const StateView& state) override { return body_->calc_potential_energy(motion(state)); }

 private:
  std::shared_ptr<SimbodyBody> body_;
};

}  // namespace

SimbodyTerms make_simbody_terms(int block_id, const ToolSpec& spec, const Vec3& gravity) {
  const auto body = std::make_shared<SimbodyBody>(rigid_parameters(spec, gravity));
  return {std::make_shared<SimbodyInertia>(block_id, body), std::make_shared<SimbodyForce>(block_id, body)};
}

// I = 2/5 m r^2 gives r; the rate is sqrt(k/m), or 1/s for a tool without coupling stiffness.
dynamics::BlockSpec tool_block(const ToolSpec& spec) {
  const RigidParameters p = rigid_parameters(spec, Vec3::Zero());
  const double length =
      spec.shape == ToolShape::kSphere ? spec.radius_m : std::sqrt(2.5 * p.inertia.mean() / p.mass);
  const double rate =
      spec.coupling.stiffness_n_m > 0.0 ? std::sqrt(spec.coupling.stiffness_n_m / p.mass) : 1.0;
  return rigid_block("tool", length, length * rate);
}

}  // namespace palpate::tool
