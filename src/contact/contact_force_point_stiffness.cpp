#include "contact/contact_force_impl.h"

namespace palpate::contact {

using dynamics::PointStiffness;

bool ContactForce::is_point_stiffness() const { return traits().symmetric_tangent; }

// A sample with friction is one point, x_a - x_b: K and D are the derivatives of its force with respect to it
// (tangent.h).
void ContactForce::add_step(const dynamics::StateView& state, const VecX& shift, double k_scale,
                            double d_scale, VecX& f, PointStiffness& C) {
  Impl& m = *impl_;
  m.place_frames(state);
  m.add_forces(state, f);
  m.product.setZero(f.size());
  m.apply_tangents(state, 1.0, 0.0, shift, m.product);
  f -= m.product;
  m.linearise_friction(state);
  const auto add = [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
    const SampleForce force = m.tangent_of(s, motion, law, law.symmetric_tangent);
    PointStiffness::OfPoint point;
    const auto take = [&](const SurfacePoint& p, double sign) {
      for (int i = 0; p.frame < 0 && i < p.count; ++i) {
        const int at = point.nodes.count++;
        point.nodes.node[static_cast<std::size_t>(at)] = p.node[static_cast<std::size_t>(i)];
        point.weight[at] = sign * p.weight[static_cast<std::size_t>(i)];
      }
    };
    take(s.a, 1.0);
    take(s.b, -1.0);
    point.nodes.relative = s.a.frame < 0 && s.b.frame < 0;
    point.C = k_scale * force.K + d_scale * force.D;
    if (point.nodes.count > 0) C.points.push_back(point);
  };
  m.visit_active(state, Impl::Which::kOfState, add);
  m.bonds.add_points(state, m.frame_states, k_scale, d_scale, C);
}

void ContactForce::add_step_force(const dynamics::StateView& state, const VecX& shift, const VecX& change,
                                  VecX& f) {
  Impl& m = *impl_;
  m.place_frames(state);
  m.add_forces(state, f);
  m.product.setZero(f.size());
  m.apply_tangents(state, 1.0, 0.0, shift, m.product);
  m.apply_tangents(state, 0.0, 1.0, change, m.product);
  f -= m.product;
  m.linearise_friction(state);
}

}  // namespace palpate::contact
