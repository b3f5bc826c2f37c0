#include "palpate/tool/tool.h"

#include <cmath>

#include "palpate/core/error.h"
#include "simbody_body.h"
#include "tick_scheme.h"

namespace palpate::tool {

struct Tool::Impl {
  Impl(const ToolSpec& spec, const Vec3& gravity)
      : body(rigid_parameters(spec, gravity)),
        scheme(find(tick_scheme_registry(), spec.integrator, "tool integrator").make(body)) {
    motion.pose = {quaternion_of(spec.rotation_vector_rad), spec.position_m};
    input.gains = coupling_gains(spec);
  }

  SimbodyBody body;
  std::unique_ptr<TickScheme> scheme;
  double time = 0.0;
  RigidMotion motion;
  TickInput input;
};

namespace {

const ToolSpec& checked(const ToolSpec& spec) {
  find(tick_scheme_registry(), spec.integrator, "tool integrator");  // fails before anything costly is built
  return spec;
}

}  // namespace

Tool::Tool(const ToolSpec& spec, const Vec3& gravity)
    : impl_(std::make_unique<Impl>(checked(spec), gravity)) {}
Tool::~Tool() = default;
Tool::Tool(Tool&&) noexcept = default;

double Tool::time() const { return impl_->time; }
Pose Tool::pose() const { return impl_->motion.pose; }
Twist Tool::twist() const { return impl_->motion.twist; }

void Tool::set_state(double t, const Pose& pose, const Twist& twist) {
  const RigidMotion motion{pose, twist};
  PALPATE_CHECK(std::isfinite(t) && is_finite(motion), "tool state at t = {} is not finite", t);
  PALPATE_CHECK(pose.rotation.norm() > 0.0, "tool rotation is the zero quaternion at t = {}", t);
  impl_->time = t;
  impl_->motion = motion;
  impl_->motion.pose.rotation.normalize();
  impl_->scheme->reset();
}

dynamics::StepResult Tool::advance(double h, const HandleMotion& handle,
                                   const dynamics::LinearisedContact& contact) {
  PALPATE_CHECK(h > 0.0 && std::isfinite(h), "tick length = {} s must be positive and finite", h);
  Impl& me = *impl_;
  me.input.t0 = me.time;
  me.input.h = h;
  me.input.handle = handle;
  me.input.contact = contact;
  const auto not_finite = [&](const char* what) {
    me.scheme->reset();
    return dynamics::StepResult{
        dynamics::StepStatus::kNotFinite,
        me.time,
        h,
        0,
        0,
        0.0,
        fmt::format("tool at t = {:.9g} s: {} not finite; the tool keeps its last state", me.time, what)};
  };
  if (!is_finite(me.input)) return not_finite("the handle state or the contact record is");
  RigidMotion next = me.motion;
  dynamics::StepResult result = me.scheme->advance(me.input, next);
  if (!result.ok()) return result;
  if (!is_finite(next)) return not_finite("the new state of the tool is");
  me.motion = next;
  me.time += h;
  return result;
}

StepEquation Tool::step_equation(double h, const HandleMotion& handle,
                                 const dynamics::LinearisedContact& contact) const {
  Impl& me = *impl_;
  return linearly_implicit_step(me.body, {me.time, h, handle, contact, me.input.gains}, me.motion);
}

RigidMotion Tool::after(double h, const Vec6& change) const {
  RigidMotion out = impl_->motion;
  move(out, h, stacked(out.twist) + change);
  return out;
}

Wrench Tool::coupling_wrench(const Pose& handle, const Twist& handle_twist) const {
  return wrench_of(tool::coupling_wrench(impl_->input.gains, impl_->motion, {handle, handle_twist}));
}

// Opposite force and moment, each about the origin of the side on which it acts. With this pair the coupling
// dissipates b |v_h - v_t|^2 + b_r |omega_h - omega_t|^2 and stores the rest of the energy that it receives:
// it is passive at both ends. (Moving the force to the other origin would add the moment of the damping
// force, with either sign.)
Wrench Tool::wrench_on_hand(const Pose& handle, const Twist& handle_twist) const {
  const Wrench on_tool = coupling_wrench(handle, handle_twist);
  return {-on_tool.moment, -on_tool.force};
}

void Tool::coupling_tangent(const Pose& handle, const Twist&, Mat6& K, Mat6& B) const {
  K = coupling_stiffness(impl_->input.gains, impl_->motion.pose, handle);
  B = coupling_damping(impl_->input.gains);
}

Mat6 Tool::mass_matrix() const { return impl_->body.mass_matrix(impl_->motion.pose); }

double Tool::kinetic_energy() const {
  const Vec6 u = stacked(impl_->motion.twist);
  return 0.5 * u.dot(mass_matrix() * u);
}

double Tool::potential_energy(const Pose& handle) const {
  const RigidParameters& p = impl_->body.parameters();
  return coupling_energy(handle) - p.mass * p.gravity.dot(impl_->motion.pose.translation);
}

double Tool::coupling_energy(const Pose& handle) const {
  return tool::coupling_energy(impl_->input.gains, impl_->motion.pose, handle);
}

bool available() { return true; }

const std::vector<ToolIntegratorInfo>& tool_integrators() {
  static const std::vector<ToolIntegratorInfo> infos = [] {
    std::vector<ToolIntegratorInfo> out;
    for (const auto& entry : tick_scheme_registry()) out.push_back({entry.name, entry.summary, entry.order});
    return out;
  }();
  return infos;
}

std::string simbody_version() { return PALPATE_SIMBODY_VERSION; }

}  // namespace palpate::tool
