#include "contact/contact_force_impl.h"
#include "contact/reduced_contact_model.h"
#include "palpate/core/error.h"

namespace palpate::contact {

std::vector<ReducedSample> ContactForce::reduced_samples(const dynamics::StateView& state, int frame,
                                                         std::vector<ReducedTangent>* tangents) const {
  Impl& m = *impl_;
  PALPATE_CHECK(frame >= 0 && frame < static_cast<int>(m.frames.size()), "frame {} of {}", frame,
                m.frames.size());
  m.place_frames(state);
  std::vector<ReducedSample> out;
  const std::size_t most = m.samples.size();
  out.reserve(most);
  if (tangents) {
    tangents->clear();
    tangents->reserve(most);
  }
  const auto append = [&](const ContactSample& s, const FrictionLine* line) {
    const bool is_a = s.a.frame == frame, is_b = s.b.frame == frame;
    const SurfacePoint& mine = is_a ? s.a : s.b;
    const SurfacePoint& other = is_a ? s.b : s.a;
    if (is_a == is_b || other.frame >= 0 || !(s.area > 0.0)) return;
    const SampleMotion motion = sample_motion(s, state, m.frame_states);
    const PressureLaw& law = m.pairs[static_cast<std::size_t>(s.source)].law;
    const double sign = is_a ? 1.0 : -1.0;
    const PointMotion& body = is_a ? motion.b : motion.a;
    const bool presses = motion.gap < 0.0;
    const SampleForce at = line ? sample_force_and_tangent(s, motion, law, *line)
                                : sample_force_and_tangent(s, motion, law, law.symmetric_tangent);
    const double slope = presses ? -pressure(law, motion.gap, motion.rate).dp_dgap : law.k;
    out.push_back({.offset = mine.offset,
                   .slide = mine.slide,
                   .count = other.count,
                   .node = other.node,
                   .weight = other.weight,
                   .normal = sign * s.normal,
                   .place = body.x,
                   .velocity = body.v,
                   .area = s.area,
                   .gap = motion.gap,
                   .pair = s.source,
                   .stiffness = s.area * slope,
                   .force = presses ? Vec3(sign * at.force) : Vec3(Vec3::Zero()),
                   .deflection = sign * law.retardation * s.deflection_rate,
                   .friction_stiffness = presses && law.retardation > 0.0
                                             ? law.friction * s.area * pressure(law, motion.gap, 0.0).p /
                                                   (law.retardation * law.regularisation)
                                             : 0.0});
    if (tangents) tangents->push_back({at.K, at.D});
  };
  for (const Impl::Pair& pair : m.pairs) {
    const bool has_line = m.has_step_friction(pair.law);
    FrictionLine line;
    for (std::size_t i = pair.begin; i < pair.end; ++i) {
      if (has_line) line = m.line_of(m.samples[i]);
      append(m.samples[i], has_line ? &line : nullptr);
    }
  }
  m.bonds.append_reduced_samples(state, m.frame_states, frame, out, tangents);
  return out;
}

}  // namespace palpate::contact
