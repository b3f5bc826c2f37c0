#include "palpate/contact/contact_force.h"

#include <algorithm>
#include <cstring>

#include "contact/contact_force_impl.h"
#include "core/counters.h"
#include "core/finite.h"
#include "palpate/core/error.h"

namespace palpate::contact {

void ContactForce::Impl::place_frames_alone(const dynamics::StateView& state) {
  frame_states.resize(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    FrameState& out = frame_states[i];
    out.pose = frames[i]->pose(state);
    out.R = out.pose.rotation.toRotationMatrix();
    out.twist = frames[i]->twist(state);
    out.u_offset = frames[i]->u_offset(state);
  }
}

void ContactForce::Impl::place_frames(const dynamics::StateView& state) {
  place_frames_alone(state);
  follow(state);
}

// Force, tangent and events of one state are requested one after another; the shape is evaluated once for
// all. Equal times do not imply equal poses of a moving frame, because its known trajectory may have been
// extended.
//
// The end of one step is the start of the next, whose forces are evaluated at the time of its own end:
// positions and poses are the same, and so are samples that follow, since gaps depend on these alone. This
// does not hold for friction springs, which move with time, and for samples of a query, which are not yet
// nearest points to rounding.
bool ContactForce::Impl::is_followed(const dynamics::StateView& state) const {
  const bool any_time = !followed.by_query && std::none_of(pairs.begin(), pairs.end(),
                                                           [](const Pair& p) { return p.anchors.on(); });
  if (followed.query != statistics.queries || (!any_time && followed.time != state.time)) return false;
  if (followed.q.size() != state.q.size() || followed.poses.size() != frames.size()) return false;
  const auto bytes = static_cast<std::size_t>(state.q.size()) * sizeof(double);
  if (std::memcmp(followed.q.data(), state.q.data(), bytes) != 0) return false;
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (followed.poses[i].translation != frame_states[i].pose.translation ||
        followed.poses[i].rotation.coeffs() != frame_states[i].pose.rotation.coeffs())
      return false;
  return true;
}

void ContactForce::Impl::follow(const dynamics::StateView& state) {
  if (!has_followers()) return;
  // Not finite: a failed trial of an integrator, whose force is not finite either.
  if (is_followed(state) || !all_finite(state.q)) return;
  note_followed(state, false);
  for (const Pair& pair : pairs) {
    if (!pair.follows) continue;
    const auto own = std::span(samples).subspan(pair.begin, pair.end - pair.begin);
    pair.source->follow(state, own);
    if (pair.anchors.on()) pair.anchors.follow(own, state, frame_states);
    if (pair.law.per_point)
      for (ContactSample& sample : own) count_as_point(sample);
  }
}

bool ContactForce::Impl::has_followers() const {
  return std::any_of(pairs.begin(), pairs.end(), [](const Pair& pair) { return pair.follows; });
}

void ContactForce::Impl::note_followed(const dynamics::StateView& state, bool by_query) {
  followed.by_query = by_query;
  followed.query = statistics.queries;
  followed.time = state.time;
  followed.q = state.q;
  followed.poses.clear();
  for (const auto& frame : frames) followed.poses.push_back(frame->pose(state));
}

const std::vector<int>& ContactForce::Impl::rows_of_frames() {
  frame_rows.clear();
  for (const FrameState& frame : frame_states) frame_rows.push_back(frame.u_offset);
  return frame_rows;
}

void ContactForce::Impl::add_forces(const dynamics::StateView& state, VecX& f) {
  if (!bonds.empty()) bonds.add_force(state, frame_states, rows_of_frames(), f);
  const auto row = [&](const SurfacePoint& p) {
    return p.frame >= 0 ? frame_states[static_cast<std::size_t>(p.frame)].u_offset : -1;
  };
  visit_active(state, Which::kOfState,
               [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
                 const Vec3 force = force_of(s, motion, law);
                 add_point_force(s.a, motion.a.arm, force, row(s.a), f);
                 add_point_force(s.b, motion.b.arm, -force, row(s.b), f);
               });
}

void ContactForce::Impl::apply_tangents(const dynamics::StateView& state, double k_scale, double d_scale,
                                        const VecX& x, VecX& y) {
  bonds.apply_tangent(state, frame_states, k_scale, d_scale, x, y);
  visit_active(state, Which::kOfState,
               [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
                 const SampleForce force = tangent_of(s, motion, law, law.symmetric_tangent);
                 apply_sample_tangent(Side(s.a, motion.a, frame_states, 1.0, force.force),
                                      Side(s.b, motion.b, frame_states, -1.0, force.force), force, k_scale,
                                      d_scale, x, y);
               });
}

void ContactForce::Impl::all_forces(const dynamics::StateView& state, VecX& f, std::vector<Wrench>& on_a) {
  const int nodal = state.layout->nodal_size;
  f.setZero(nodal + 6 * static_cast<Eigen::Index>(frames.size()));
  place_frames(state);
  frame_rows.resize(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) frame_rows[i] = nodal + 6 * static_cast<int>(i);
  const auto add = [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
    const Vec3 force = sample_force(s, motion, law);
    add_point_force(s.a, motion.a.arm, force, nodal + 6 * s.a.frame, f);
    add_point_force(s.b, motion.b.arm, -force, nodal + 6 * s.b.frame, f);
    on_a[static_cast<std::size_t>(s.source)] += Wrench{motion.a.x.cross(force), force};
  };
  visit_active(state, Which::kEvery, add);
  bonds.add_force(state, frame_states, frame_rows, f);
  bonds.add_resultants(state, frame_states, on_a);
}

ContactForce::ContactForce() : impl_(std::make_unique<Impl>()) { counters::count("contact.force"); }
ContactForce::~ContactForce() = default;

int ContactForce::add_frame(std::shared_ptr<MovingFrame> frame) {
  PALPATE_CHECK(frame, "a contact frame is missing");
  impl_->frames.push_back(std::move(frame));
  return static_cast<int>(impl_->frames.size()) - 1;
}

int ContactForce::add_pair(std::unique_ptr<SampleSource> source, const ContactSpec& law) {
  PALPATE_CHECK(source, "contact \"{}\" with \"{}\" has no source", law.first, law.second);
  const bool follows = source->traits().follows;
  Impl::Pair pair{.source = std::move(source), .law = pressure_law(law), .follows = follows};
  if (!follows) pair.law.retardation = 0.0;  // Anchors need material points.
  if (follows && law.friction > 0.0)
    pair.anchors = FrictionAnchors(pair.law.retardation, pair.law.regularisation);
  pair.begin = pair.end = impl_->samples.size();
  impl_->pairs.push_back(std::move(pair));
  return static_cast<int>(impl_->pairs.size()) - 1;
}

std::string_view ContactForce::name() const { return "contact"; }

// Friction has no potential. The rows of a frame in the State involve rotations, which do not commute (see
// tangent.cpp).
dynamics::TermTraits ContactForce::traits() const {
  dynamics::TermTraits traits;
  const auto& pairs = impl_->pairs;
  const bool friction =
      std::any_of(pairs.begin(), pairs.end(), [](const auto& p) { return p.law.friction > 0.0; });
  const bool unsymmetric = std::any_of(pairs.begin(), pairs.end(), [](const auto& p) {
    return p.law.friction > 0.0 && !p.law.symmetric_tangent;
  });
  const bool damping = std::any_of(pairs.begin(), pairs.end(), [](const auto& p) { return p.law.d > 0.0; });
  const bool frames =
      std::any_of(impl_->frames.begin(), impl_->frames.end(), [](const auto& f) { return f->in_state(); });
  traits.symmetric_tangent = !unsymmetric && !frames;
  traits.conservative = !friction && !damping;
  traits.contact = true;
  return traits;
}

void ContactForce::add_pattern(dynamics::PatternBuilder& pattern) const {
  for (const auto& pair : impl_->pairs) pair.source->add_pattern(pattern);
}

std::uint64_t ContactForce::pattern_version() const {
  std::uint64_t sum = impl_->pairs.size();  // All counters increase only, and so does the sum.
  for (const auto& pair : impl_->pairs) sum += pair.source->pattern_version();
  return sum;
}

void ContactForce::add_force(const dynamics::StateView& state, VecX& f) {
  Impl& m = *impl_;
  m.place_frames(state);
  m.add_forces(state, f);
}

void ContactForce::add_tangent(const dynamics::StateView& state, double k_scale, double d_scale,
                               dynamics::BorderedMatrix& A) {
  Impl& m = *impl_;
  m.place_frames(state);
  m.linearise_friction(state);
  const auto add = [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
    const SampleForce force = m.tangent_of(s, motion, law, law.symmetric_tangent);
    add_sample_tangent(Side(s.a, motion.a, m.frame_states, 1.0, force.force),
                       Side(s.b, motion.b, m.frame_states, -1.0, force.force), force, k_scale, d_scale,
                       state.layout->nodal_size, A);
  };
  m.visit_active(state, Impl::Which::kOfState, add);
  m.bonds.add_tangent(state, m.frame_states, k_scale, d_scale, A);
}

void ContactForce::apply_tangent(const dynamics::StateView& state, double k_scale, double d_scale,
                                 const VecX& x, VecX& y) {
  Impl& m = *impl_;
  m.place_frames(state);
  m.apply_tangents(state, k_scale, d_scale, x, y);
}

double ContactForce::energy(const dynamics::StateView& state) {
  Impl& m = *impl_;
  m.place_frames(state);
  double sum = m.bonds.energy(state, m.frame_states);
  m.visit_active(state, Impl::Which::kEvery,
                 [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
                   sum += s.stored * s.area * pressure(law, motion.gap, motion.rate).energy_density;
                 });
  return sum;
}

double ContactForce::dissipated_power(const dynamics::StateView& state) {
  Impl& m = *impl_;
  m.place_frames(state);
  double sum = m.bonds.dissipation(state, m.frame_states);
  m.visit_active(state, Impl::Which::kEvery,
                 [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
                   sum += sample_dissipation(s, motion, law);
                 });
  return sum;
}

void ContactForce::use_secant_tangents(bool on) {
  Impl& m = *impl_;
  PALPATE_CHECK(on == m.laws_kept.empty() || m.pairs.empty(), "secant tangents are already {}",
                on ? "in use" : "out of use");
  for (std::size_t i = 0; i < m.pairs.size(); ++i) {
    PressureLaw& law = m.pairs[i].law;
    if (on) {
      m.laws_kept.push_back(law);
      law.symmetric_tangent = law.secant_friction = true;
    } else {
      law = m.laws_kept[i];
    }
  }
  if (!on) m.laws_kept.clear();
}

// With a symmetric tangent the step uses the friction of the pressure p0 at its start:
//     F = F0 - mu p0 A ds/dv dv,   and neglects   -mu s A (p - p0).
// The norm of the sum of the neglected part over a pair's samples is recorded, at the pressure at the end of
// the step.
void ContactForce::Impl::linearise_friction(const dynamics::StateView& state) {
  if (!laws_kept.empty()) return;
  measure_friction_lag(state);
  linearised.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Pair& pair = pairs[i];
    if (!pair.law.symmetric_tangent || pair.law.friction == 0.0 || pair.given || has_step_friction(pair.law))
      continue;
    Vec3 sum = Vec3::Zero();
    for (std::size_t s = pair.begin; s < pair.end; ++s) {
      const SampleMotion motion = sample_motion(samples[s], state, frame_states);
      if (motion.gap >= 0.0) continue;
      linearised.push_back({s, i, pressure(pair.law, motion.gap, motion.rate).p,
                            friction_per_pressure(samples[s], motion, pair.law)});
      sum += linearised.back().pressure * linearised.back().per_pressure;
    }
    statistics.largest_lagged_friction = std::max(statistics.largest_lagged_friction, sum.norm());
  }
}

void ContactForce::Impl::measure_friction_lag(const dynamics::StateView& state) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < linearised.size(); ++i) {
    const Linearised& at = linearised[i];
    const SampleMotion motion = sample_motion(samples[at.sample], state, frame_states);
    const double now = motion.gap < 0.0 ? pressure(pairs[at.pair].law, motion.gap, motion.rate).p : 0.0;
    sum += (now - at.pressure) * at.per_pressure;
    if (i + 1 == linearised.size() || linearised[i + 1].pair != at.pair) {
      statistics.largest_friction_lag = std::max(statistics.largest_friction_lag, sum.norm());
      sum.setZero();
    }
  }
}

bool ContactForce::refresh(const dynamics::StateView& state) {
  Impl& m = *impl_;
  if (!m.linearised.empty()) {
    m.place_frames(state);
    m.measure_friction_lag(state);
    m.linearised.clear();
  }
  m.resultants.start(m.pairs.size());
  m.all_forces(state, m.force_before, m.resultants.before);
  m.query(state);
  m.check_samples(state);
  const bool grasped = m.take_grasps(state);
  m.all_forces(state, m.force_after, m.resultants.after);
  // next_samples holds the previous samples.
  m.resultants.compare(m.next_samples, m.samples, state, m.frames, m.statistics);
  return grasped || m.force_after != m.force_before;
}

int ContactForce::event_count() const {
  int count = 0;
  for (const auto& pair : impl_->pairs)
    if (Impl::has_events(pair)) count += static_cast<int>(pair.end - pair.begin);
  return count;
}

std::uint64_t ContactForce::events_version() const {
  impl_->compare_events();
  return impl_->events_version;
}

// Distant candidates are included: they may close before the next query. A sample with a large gap costs a
// root finder no more than one evaluation.
void ContactForce::events(const dynamics::StateView& state, double* g) {
  Impl& m = *impl_;
  m.place_frames(state);
  for (const ContactSample& s : m.samples) {
    const Impl::Pair& pair = m.pairs[static_cast<std::size_t>(s.source)];
    if (!Impl::has_events(pair)) continue;
    const SampleMotion motion = sample_motion(s, state, m.frame_states);
    *g++ = pressing(pair.law, motion.gap, motion.rate);
  }
}

std::vector<PairReport> ContactForce::pairs() const {
  std::vector<PairReport> out;
  for (const auto& pair : impl_->pairs)
    out.push_back({pair.source->report(), pair.source->traits().name, pair.deepest});
  return out;
}

std::size_t ContactForce::pair_count() const { return impl_->pairs.size(); }

double ContactForce::deepest(std::size_t pair) const { return impl_->pairs.at(pair).deepest; }

void ContactForce::keep_views() {
  for (const auto& pair : impl_->pairs) pair.source->keep_view();
}

std::vector<ContactPoint> ContactForce::points(const dynamics::StateView& state) const {
  Impl& m = *impl_;
  m.place_frames(state);
  std::vector<ContactPoint> out;
  out.reserve(m.samples.size());
  for (const ContactSample& s : m.samples) {
    // Without area there is no force, and the points need not be nearest points.
    if (s.area == 0.0) continue;
    const SampleMotion motion = sample_motion(s, state, m.frame_states);
    const double p = pressure(m.pairs[static_cast<std::size_t>(s.source)].law, motion.gap, motion.rate).p;
    out.push_back({motion.a.x, motion.b.x, s.normal, motion.gap, s.stored * motion.gap, p, s.area, s.source});
  }
  return out;
}

const std::vector<ContactSample>& ContactForce::samples() const { return impl_->samples; }
const ContactStatistics& ContactForce::statistics() const { return impl_->statistics; }

}  // namespace palpate::contact
