#pragma once
#include <string>

#include "palpate/tool/tool.h"

namespace palpate::validation {

/// The tool, or with a fault the tool with a defect; handle, wall and expected values of the case are
/// unchanged.
class FaultyTool {
 public:
  FaultyTool(const ToolSpec& spec, const std::string& fault)
      : fault_(fault), tool_(misread(spec, fault), Vec3::Zero()) {}

  void set_state(double t, const Pose& pose, const Twist& twist) { tool_.set_state(t, pose, twist); }
  dynamics::StepResult advance(double h, const tool::HandleMotion& handle,
                               dynamics::LinearisedContact contact) {
    for (double& entry : contact.J)
      entry *= fault_ == "half-contact" ? 0.5 : fault_ == "contact-pulls" ? -1.0 : 1.0;
    const bool late = fault_ == "late-handle" && !std::exchange(moved_, true);
    const Pose here = tool_.pose();
    return tool_.advance(h, late ? tool::HandleMotion{here, here, {}, {}} : handle, contact);
  }
  Pose pose() const { return tool_.pose(); }
  Twist twist() const { return tool_.twist(); }
  Wrench wrench_on_hand(const Pose& handle, const Twist& twist) const {
    Wrench wrench = tool_.wrench_on_hand(handle, twist);
    if (fault_ == "wrong-sign") wrench = {-wrench.moment, -wrench.force};
    return wrench;
  }

 private:
  static ToolSpec misread(ToolSpec spec, const std::string& fault) {
    VirtualCouplingSpec& coupling = spec.coupling;
    if (fault == "half-stiffness") {
      coupling.stiffness_n_m *= 0.5;
      coupling.rotational_stiffness_n_m_rad *= 0.5;
    }
    if (fault == "no-damping") coupling.damping_n_s_m = coupling.rotational_damping_n_m_s_rad = 0.0;
    const Vec3 I = spec.inertia_kg_m2;
    if (fault == "axes-swapped") spec.inertia_kg_m2 = Vec3(I.z(), I.x(), I.y());
    if (fault == "first-two-axes-swapped") spec.inertia_kg_m2 = Vec3(I.y(), I.x(), I.z());
    if (fault == "explicit-for-implicit" && spec.integrator == "linearly-implicit-euler")
      spec.integrator = "semi-implicit-euler";
    return spec;
  }
  std::string fault_;
  bool moved_ = false;
  tool::Tool tool_;
};

}  // namespace palpate::validation
