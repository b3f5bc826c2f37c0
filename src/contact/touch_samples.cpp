#include "contact/contact_force_impl.h"
#include "palpate/contact/touch_model.h"
#include "palpate/core/error.h"

namespace palpate::contact {

std::vector<TouchSample> ContactForce::touch_samples(const dynamics::StateView& state, int frame,
                                                     std::vector<TouchTangent>* tangents) const {
  Impl& m = *impl_;
  PALPATE_CHECK(frame >= 0 && frame < static_cast<int>(m.frames.size()), "frame {} of {}", frame,
                m.frames.size());
  m.place_frames(state);
  std::vector<TouchSample> out;
  const std::size_t most = m.all().size();
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
                   .force = presses ? Vec3(sign * at.force) : Vec3(Vec3::Zero())});
    if (tangents) tangents->push_back({at.K, at.D});
  };
  const std::vector<ContactSample>& all = m.all();
  std::size_t at = 0;
  std::vector<FrictionLine> in_cells;
  for (std::size_t p = 0; p < m.pairs.size(); ++p) {
    const Impl::Pair& pair = m.pairs[p];
    const std::size_t end = at + static_cast<std::size_t>(m.count_of(pair));
    const bool has_lines = m.has_step_friction(pair.law);
    if (has_lines && pair.in_cells) in_cells = m.friction_cells.lines_of(static_cast<int>(p));
    FrictionLine line;
    for (std::size_t i = pair.begin; i < pair.end; ++i, ++at) {
      if (has_lines) line = pair.in_cells ? in_cells[i - pair.begin] : m.line_of(m.samples[i]);
      append(m.samples[i], has_lines ? &line : nullptr);
    }
    for (; at < end; ++at) append(all[at], nullptr);
  }
  m.bonds.append_touch_samples(state, m.frame_states, frame, out, tangents);
  return out;
}

}  // namespace palpate::contact
