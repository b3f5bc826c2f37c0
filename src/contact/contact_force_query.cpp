// Query of all pairs, and the state of contact in a checkpoint.
#include <algorithm>
#include <cmath>

#include "contact/contact_force_impl.h"
#include "core/clock.h"
#include "core/counters.h"
#include "palpate/core/error.h"

namespace palpate::contact {

namespace {

/// Returns whether two samples represent the same two points, whatever their positions; points of a frame
/// slide.
bool is_same_pair(const ContactSample& s, const ContactSample& t) {
  const auto is_same = [](const SurfacePoint& p, const SurfacePoint& q) {
    return p.frame == q.frame && p.count == q.count && (p.frame >= 0 || p.node == q.node);
  };
  return s.source == t.source && is_same(s.a, t.a) && is_same(s.b, t.b);
}

void archive_size(Archive& a, std::string_view name, ResultantSize& size) {
  const Archive::Group group(a, name);
  a("force", size.force);
  a("moment", size.moment);
}

}  // namespace

void ContactForce::Impl::measure_depth(Pair& pair) const {
  double least = 0.0;
  for (std::size_t s = pair.begin; s < pair.end; ++s)
    if (next_samples[s].area > 0.0) least = std::min(least, next_samples[s].stored * next_samples[s].gap);
  pair.deepest = std::max(pair.deepest, -least);
}

void ContactForce::Impl::query(const dynamics::StateView& state) {
  const ScopedTimer timer(statistics.query_seconds);
  if (std::any_of(pairs.begin(), pairs.end(), [](const Pair& pair) { return pair.anchors.on(); }))
    place_frames_alone(state);
  next_samples.clear();
  statistics.safe_time = HUGE_VAL;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    Pair& pair = pairs[i];
    pair.begin = next_samples.size();
    pair.source->query(state, next_samples);
    pair.end = next_samples.size();
    statistics.safe_time = std::min(statistics.safe_time, pair.source->report().safe_time);
    if (pair.anchors.on())
      pair.anchors.renew(std::span(next_samples).subspan(pair.begin), pair.source->material_points(), state,
                         frame_states);
    measure_depth(pair);
    for (std::size_t s = pair.begin; s < pair.end; ++s) {
      next_samples[s].source = static_cast<int>(i);
      if (pair.law.per_point) count_as_point(next_samples[s]);
    }
  }
  ++statistics.queries;
  counters::count("contact.query");
  std::swap(samples, next_samples);
  if (has_followers()) note_followed(state, true);  // The samples are up to date for this state.
  find_given();
  // The version was not requested between two queries: no comparison is needed.
  if (events_to_compare) ++events_version;
  events_to_compare = true;
}

// The contact at the state of the grasp command is found first: what presses there is held.
bool ContactForce::Impl::take_grasps(const dynamics::StateView& state) {
  GraspCounts& counts = statistics.grasps;
  bool changed = false;
  for (Grasp& grasp : grasps) {
    if (grasp.requested == grasp.closed) continue;
    grasp.closed = grasp.requested;
    if (!grasp.closed) {
      changed = changed || bonds.count_of(grasp.frame) > 0;
      bonds.let_go(grasp.frame);
      continue;
    }
    std::vector<PressureLaw> laws;
    for (const Pair& pair : pairs) laws.push_back(pair.law);
    place_frames(state);
    const bool holds = bonds.take(samples, grasp.frame, laws, state, frame_states) > 0;
    changed = changed || holds;
    ++(holds ? counts.closed : counts.empty);
  }
  counts.points = bonds.count();
  counts.area = bonds.area();
  counts.largest_area = std::max(counts.largest_area, counts.area);
  return changed;
}

void ContactForce::set_grasp(int frame, bool closed) {
  Impl& m = *impl_;
  PALPATE_CHECK(frame >= 0 && frame < static_cast<int>(m.frames.size()), "frame {} of {}", frame,
                m.frames.size());
  const auto of_frame = std::find_if(m.grasps.begin(), m.grasps.end(),
                                     [&](const Impl::Grasp& grasp) { return grasp.frame == frame; });
  if (of_frame != m.grasps.end())
    of_frame->requested = closed;
  else if (closed)
    m.grasps.push_back({.frame = frame, .requested = true});
}

void ContactForce::tie(int frame, const std::vector<Tie>& ties) {
  PALPATE_CHECK(frame >= 0 && frame < static_cast<int>(impl_->frames.size()), "frame {} of {}", frame,
                impl_->frames.size());
  impl_->bonds.tie(frame, ties);
}

void ContactForce::Impl::compare_events() {
  if (!events_to_compare) return;
  events_to_compare = false;
  if (!std::equal(samples.begin(), samples.end(), next_samples.begin(), next_samples.end(), is_same_pair))
    ++events_version;
}

void ContactForce::Impl::find_given() {
  for (Pair& pair : pairs) {
    const auto own = std::span(samples).subspan(pair.begin, pair.end - pair.begin);
    pair.given = !own.empty() && std::all_of(own.begin(), own.end(), [&](const ContactSample& s) {
      const auto is_given = [&](const SurfacePoint& p) {
        return p.frame >= 0 && !frames[static_cast<std::size_t>(p.frame)]->in_state();
      };
      return is_given(s.a) && is_given(s.b);
    });
  }
}

void ContactForce::Impl::check_samples(const dynamics::StateView& state) const {
  const int frame_count = static_cast<int>(frames.size()), node_count = state.layout->node_count();
  const auto check = [&](const SurfacePoint& p) {
    PALPATE_CHECK(p.frame < frame_count && (p.frame >= 0 || (p.count > 0 && p.count <= 4)),
                  "contact sample: frame {} of {}, {} nodes", p.frame, frame_count, p.count);
    for (int i = 0; p.frame < 0 && i < p.count; ++i)
      PALPATE_CHECK(p.node[static_cast<std::size_t>(i)] < node_count, "contact sample: node {} of {}",
                    p.node[static_cast<std::size_t>(i)], node_count);
  };
  for (const ContactSample& s : samples) {
    check(s.a);
    check(s.b);
    PALPATE_CHECK(s.area >= 0.0 && s.normal.allFinite(), "contact sample: area {}", s.area);
  }
}

// The query comes last, because it uses the restored state of earlier queries.
void ContactForce::archive(Archive& a, const dynamics::StateView& state) {
  Impl& m = *impl_;
  a.each("pair", m.pairs, [&](Impl::Pair& pair) {
    pair.source->archive(a);
    a("deepest", pair.deepest);
    if (pair.anchors.on()) pair.anchors.archive(a);
  });
  a("bonds", m.bonds);
  a.list("grasp", m.grasps, [&](Impl::Grasp& grasp) {
    a("frame", grasp.frame);
    a("wanted", grasp.requested);
    a("closed", grasp.closed);
  });
  ContactStatistics& all = m.statistics;
  GraspCounts& grasped = all.grasps;
  a("grasps_closed", grasped.closed);
  a("grasps_empty", grasped.empty);
  a("grasped_points", grasped.points);
  a("grasped_area", grasped.area);
  a("largest_grasped_area", grasped.largest_area);
  a("queries", all.queries);
  a("query_seconds", all.query_seconds);
  archive_size(a, "largest_jump", all.largest_jump);
  archive_size(a, "largest_after", all.largest_resultant);
  a("largest_friction_lag", all.largest_friction_lag);
  a("largest_friction", all.largest_lagged_friction);
  if (!a.is_restoring()) return;
  m.query(state);
  m.check_samples(state);
}

}  // namespace palpate::contact
