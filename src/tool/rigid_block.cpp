#include "tool/rigid_block.h"

#include "coupling.h"
#include "parameters.h"

namespace palpate::tool {
namespace {

using dynamics::StateView;

class CouplingTerm : public dynamics::RigidForce {
 public:
  CouplingTerm(int block_id, const CouplingGains& gains, HandlePath handle, bool symmetric)
      : RigidForce(block_id), gains_(gains), handle_(std::move(handle)), symmetric_(symmetric) {}
  std::string_view name() const override { return "virtual coupling"; }
  dynamics::TermTraits traits() const override {
    return {.fast = true, .symmetric_tangent = symmetric_, .conservative = true};
  }
  Vec6 force(double t, const RigidMotion& m) const override { return coupling_wrench(gains_, m, handle(t)); }
  Mat6 tangent(double t, const RigidMotion& m, double k_scale, double d_scale) const override {
    Mat6 K = coupling_stiffness(gains_, m.pose, handle(t).pose);
    if (symmetric_) K = (0.5 * (K + K.transpose())).eval();
    return k_scale * K + d_scale * coupling_damping(gains_);
  }
  double energy(const StateView& state) override {
    return coupling_energy(gains_, motion(state).pose, handle(state.time).pose);
  }
  double dissipated_power(const StateView& state) override {
    return coupling_dissipation(gains_, motion(state).twist, handle(state.time).twist);
  }

 private:
  RigidMotion handle(double t) const {
    const HandleState h = handle_(t);
    return {h.pose, h.twist};
  }

  CouplingGains gains_;
  HandlePath handle_;
  bool symmetric_;
};

}  // namespace

Wrench coupling_on_hand(const ToolSpec& spec, const HandleState& tool, const HandleState& handle) {
  const Wrench on_tool =
      wrench_of(coupling_wrench(coupling_gains(spec), {tool.pose, tool.twist}, {handle.pose, handle.twist}));
  return {-on_tool.moment, -on_tool.force};
}

RigidTerms make_rigid_terms(int block_id, const ToolSpec& spec, const Vec3& gravity) {
  const RigidParameters p = rigid_parameters(spec, gravity);
  RigidTerms out{make_rigid_inertia(block_id, p.mass, p.inertia),
                 {make_gyroscopic(block_id, p.inertia, true)}};
  if (!p.gravity.isZero()) out.forces.push_back(make_rigid_weight(block_id, p.mass, p.gravity));
  return out;
}

std::shared_ptr<dynamics::ForceTerm> make_coupling_term(int block_id, const ToolSpec& spec, HandlePath handle,
                                                        bool symmetric) {
  return std::make_shared<CouplingTerm>(block_id, coupling_gains(spec), std::move(handle), symmetric);
}

}  // namespace palpate::tool
