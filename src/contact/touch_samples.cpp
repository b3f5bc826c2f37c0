#include "contact/contact_force_impl.h"
#include "palpate/contact/touch_model.h"
#include "palpate/core/error.h"

namespace palpate::contact {

std::vector<TouchSample> ContactForce::touch_samples(const dynamics::StateView& state, int frame) const {
  Impl& m = *impl_;
  PALPATE_CHECK(frame >= 0 && frame < static_cast<int>(m.frames.size()), "frame {} of {}", frame,
                m.frames.size());
  m.place_frames(state);
  std::vector<TouchSample> out;
  for (const ContactSample& s : m.all()) {
    const bool is_a = s.a.frame == frame, is_b = s.b.frame == frame;
    const SurfacePoint& other = is_a ? s.b : s.a;
    if (is_a == is_b || other.frame >= 0 || !(s.area > 0.0)) continue;
    const SampleMotion motion = sample_motion(s, state, m.frame_states);
    const PressureLaw& law = m.pairs[static_cast<std::size_t>(s.source)].law;
    const double sign = is_a ? 1.0 : -1.0;
    const PointMotion& body = is_a ? motion.b : motion.a;
    const SampleForce force = sample_force_and_tangent(s, motion, law, law.symmetric_tangent);
    const Vec3 normal = sign * s.normal;
    out.push_back({is_a ? s.a : s.b, other, normal, body.x, body.v, s.area, motion.gap, s.source,
                   sign * force.force, force.K, force.D, s.area * law.k * normal * normal.transpose()});
  }
  return out;
}

}  // namespace palpate::contact
