#include <algorithm>

#include "contact/contact_force_impl.h"

namespace palpate::contact {

using dynamics::PointStiffness;

bool ContactForce::is_point_stiffness() const {
  const auto& pairs = impl_->pairs;
  return std::none_of(pairs.begin(), pairs.end(), [](const Impl::Pair& pair) {
    return pair.law.friction > 0.0 && !pair.law.symmetric_tangent;
  });
}

// A sample with friction is one point, x_a - x_b: K and D are the derivatives of its force with respect to it
// (tangent.h).
void ContactForce::add_step(const dynamics::StateView& state, const VecX& shift, double k_scale,
                            double d_scale, VecX& f, PointStiffness& C, dynamics::SparseBorder& border) {
  Impl& m = *impl_;
  m.place_frames(state);
  m.linearise_friction(state);
  if (!m.bonds.empty()) {
    m.bonds.add_force(state, m.frame_states, m.rows_of_frames(), f);
    m.bonds.apply_tangent(state, m.frame_states, -1.0, 0.0, shift, f);
    m.bonds.add_points(state, m.frame_states, k_scale, d_scale, C, border);
  }
  const auto row = [&](const SurfacePoint& p) {
    return p.frame >= 0 ? m.frame_states[static_cast<std::size_t>(p.frame)].u_offset : -1;
  };
  const auto add = [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
    const SampleForce force = m.tangent_of(s, motion, law, law.symmetric_tangent);
    const Side a(s.a, motion.a, m.frame_states, 1.0, force.force),
        b(s.b, motion.b, m.frame_states, -1.0, force.force);
    add_point_force(s.a, motion.a.arm, force.force, row(s.a), f);
    add_point_force(s.b, motion.b.arm, -force.force, row(s.b), f);
    apply_sample_tangent(a, b, force, -1.0, 0.0, shift, f);
    add_sample_tangent(a, b, force, k_scale, d_scale, state.layout->nodal_size, C, border);
  };
  m.visit_active(state, Impl::Which::kOfState, add);
}

void ContactForce::add_step_force(const dynamics::StateView& state, const VecX& shift, const VecX& change,
                                  VecX& f) {
  Impl& m = *impl_;
  m.place_frames(state);
  m.product.setZero(f.size());
  if (!m.bonds.empty()) {
    m.bonds.add_force(state, m.frame_states, m.rows_of_frames(), f);
    m.bonds.apply_tangent(state, m.frame_states, 1.0, 0.0, shift, m.product);
    m.bonds.apply_tangent(state, m.frame_states, 0.0, 1.0, change, m.product);
  }
  const auto row = [&](const SurfacePoint& p) {
    return p.frame >= 0 ? m.frame_states[static_cast<std::size_t>(p.frame)].u_offset : -1;
  };
  const auto add = [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
    const SampleForce force = m.tangent_of(s, motion, law, law.symmetric_tangent);
    const Side a(s.a, motion.a, m.frame_states, 1.0, force.force),
        b(s.b, motion.b, m.frame_states, -1.0, force.force);
    add_point_force(s.a, motion.a.arm, force.force, row(s.a), f);
    add_point_force(s.b, motion.b.arm, -force.force, row(s.b), f);
    apply_sample_tangent(a, b, force, 1.0, 0.0, shift, m.product);
    apply_sample_tangent(a, b, force, 0.0, 1.0, change, m.product);
  };
  m.visit_active(state, Impl::Which::kOfState, add);
  f -= m.product;
  m.linearise_friction(state);
}

}  // namespace palpate::contact
