// A query of all pairs, and the forms that its samples are kept in.
#include <algorithm>

#include "contact/contact_force_impl.h"
#include "contact/image_source.h"
#include "palpate/core/clock.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"

namespace palpate::contact {

namespace {

/// Whether two samples stand for the same two points, wherever these are now: the points of a frame slide.
bool is_same_pair(const ContactSample& s, const ContactSample& t) {
  const auto is_same = [](const SurfacePoint& p, const SurfacePoint& q) {
    return p.frame == q.frame && p.count == q.count && (p.frame >= 0 || p.node == q.node);
  };
  return s.source == t.source && is_same(s.a, t.a) && is_same(s.b, t.b);
}

/// Springs of their own, as count_as_point.
void count_as_points(SampleCells& cells, ContactCell& cell) {
  if (cell.area >= 0.0) cell.area = cell.area > 0.0 ? 1.0 : 0.0;
  for (int i = cell.first; cell.area < 0.0 && i < cell.last; ++i) {
    double& area = cells.areas[static_cast<std::size_t>(i)];
    area = area > 0.0 ? 1.0 : 0.0;
  }
}

}  // namespace

void ContactForce::Impl::measure_depth(Pair& pair) const {
  double least = 0.0;
  for (std::size_t s = pair.begin; s < pair.end; ++s)
    if (next_samples[s].area > 0.0) least = std::min(least, next_samples[s].stored * next_samples[s].gap);
  for (std::size_t c = pair.first_cell; c < pair.last_cell; ++c)
    for (int i = next_cells.cells[c].first; i < next_cells.cells[c].last; ++i) {
      if (!(next_cells.area(next_cells.cells[c], i) > 0.0)) continue;
      const SamplePlace& place = next_cells.places[static_cast<std::size_t>(i)];
      least = std::min(least, place.w_a - place.w_b);
    }
  pair.deepest = std::max(pair.deepest, -least);
}

// Samples of an image stay in cells; those with friction are also listed one by one.
void ContactForce::Impl::query(const dynamics::StateView& state) {
  const ScopedTimer timer(query_seconds);
  if (std::any_of(pairs.begin(), pairs.end(), [](const Pair& pair) { return pair.anchors.on(); }))
    place_frames_alone(state);
  next_samples.clear();
  next_cells.clear();
  friction_cells.clear();
  rubbing.clear();
  together.clear();
  for (Pair& pair : pairs)
    if (ImageSource* source = pair.source->in_images(); source && source->asks_together()) {
      source->open(state);
      together.push_back(source);
    }
  answer_together(together);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    Pair& pair = pairs[i];
    pair.begin = next_samples.size();
    pair.first_cell = next_cells.cells.size();
    pair.first_rubbing = rubbing.cells.size();
    if (ImageSource* source = pair.source->in_images()) {
      SampleCells& out = pair.law.friction == 0.0 ? next_cells : pair.law.secant_friction ? rubbing : apart;
      apart.clear();
      if (std::find(together.begin(), together.end(), source) != together.end())
        source->close(out);
      else
        source->query(state, out);
      rubbing.append_to(next_samples, pair.first_rubbing, rubbing.cells.size());
      apart.append_to(next_samples);
    } else {
      pair.source->query(state, next_samples);
    }
    pair.end = next_samples.size();
    if (pair.anchors.on())
      pair.anchors.renew(std::span(next_samples).subspan(pair.begin), pair.source->material_points(), state,
                         frame_states);
    pair.last_cell = next_cells.cells.size();
    pair.last_rubbing = rubbing.cells.size();
    measure_depth(pair);
    for (std::size_t s = pair.begin; s < pair.end; ++s) {
      next_samples[s].source = static_cast<int>(i);
      if (pair.law.per_point) count_as_point(next_samples[s]);
    }
    const auto count_cells = [&](SampleCells& of, std::size_t first, std::size_t last) {
      for (std::size_t c = first; c < last; ++c) {
        of.cells[c].pair = static_cast<int>(i);
        if (pair.law.per_point) count_as_points(of, of.cells[c]);
      }
    };
    count_cells(next_cells, pair.first_cell, pair.last_cell);
    count_cells(rubbing, pair.first_rubbing, pair.last_rubbing);
  }
  ++queries;
  counters::count("contact.query");
  std::swap(samples, next_samples);
  std::swap(cells, next_cells);
  all_made = false;
  if (has_followers()) note_followed(state);  // what was found now is nearest now
  group_samples();
  if (events_to_compare) ++events_version;  // nobody asked between two queries: no comparison is needed
  events_to_compare = true;
}

// Contact of the state that the grasp closes at is found first: what presses is held.
bool ContactForce::Impl::take_grasps(const dynamics::StateView& state) {
  bool changed = false;
  for (Grasp& grasp : grasps) {
    if (grasp.wanted == grasp.closed) continue;
    grasp.closed = grasp.wanted;
    if (!grasp.closed) {
      changed = changed || bonds.count_of(grasp.frame) > 0;
      bonds.let_go(grasp.frame);
      continue;
    }
    std::vector<PressureLaw> laws;
    for (const Pair& pair : pairs) laws.push_back(pair.law);
    place_frames(state);
    const bool holds = bonds.take(all(), grasp.frame, laws, state, frame_states) > 0;
    changed = changed || holds;
    ++(holds ? grasp_counts.closed : grasp_counts.empty);
  }
  grasp_counts.points = bonds.count();
  grasp_counts.area = bonds.area();
  grasp_counts.largest_area = std::max(grasp_counts.largest_area, grasp_counts.area);
  return changed;
}

void ContactForce::set_grasp(int frame, bool closed) {
  Impl& m = *impl_;
  PALPATE_CHECK(frame >= 0 && frame < static_cast<int>(m.frames.size()), "frame {} of {}", frame,
                m.frames.size());
  const auto of_frame = std::find_if(m.grasps.begin(), m.grasps.end(),
                                     [&](const Impl::Grasp& grasp) { return grasp.frame == frame; });
  if (of_frame != m.grasps.end())
    of_frame->wanted = closed;
  else if (closed)
    m.grasps.push_back({.frame = frame, .wanted = true});
}

void ContactForce::tie(int frame, const std::vector<Tie>& ties) {
  PALPATE_CHECK(frame >= 0 && frame < static_cast<int>(impl_->frames.size()), "frame {} of {}", frame,
                impl_->frames.size());
  impl_->bonds.tie(frame, ties);
}

GraspCounts ContactForce::grasp_counts() const { return impl_->grasp_counts; }

double ContactForce::sample_bytes() const {
  const Impl& m = *impl_;
  return static_cast<double>(m.samples.size() * sizeof(ContactSample) + m.cells.bytes() + m.rubbing.bytes() +
                             m.groups.bytes());
}

int ContactForce::Impl::count_of(const Pair& pair) const {
  auto count = static_cast<int>(pair.end - pair.begin);
  for (std::size_t c = pair.first_cell; c < pair.last_cell; ++c)
    count += cells.cells[c].last - cells.cells[c].first;
  return count;
}

const std::vector<ContactSample>& ContactForce::Impl::all() {
  if (cells.cells.empty()) return samples;
  if (all_made) return all_samples;
  all_made = true;
  all_samples.clear();
  for (const Pair& pair : pairs) {
    all_samples.insert(all_samples.end(), samples.begin() + static_cast<std::ptrdiff_t>(pair.begin),
                       samples.begin() + static_cast<std::ptrdiff_t>(pair.end));
    cells.append_to(all_samples, pair.first_cell, pair.last_cell);
  }
  return all_samples;
}

void ContactForce::Impl::compare_events() {
  if (!events_to_compare) return;
  events_to_compare = false;
  if (!std::equal(samples.begin(), samples.end(), next_samples.begin(), next_samples.end(), is_same_pair) ||
      !cells.have_points_of(next_cells))
    ++events_version;
}

/// Whether only nodes move within a step: side a stands on nodes, and side b on nodes or on a given frame.
bool ContactForce::Impl::can_rub_in_cells(const Pair& pair) const {
  const auto carrier = [&](int c) -> const Carrier& { return rubbing.carriers[static_cast<std::size_t>(c)]; };
  bool out = pair.first_rubbing < pair.last_rubbing;
  for (std::size_t c = pair.first_rubbing; c < pair.last_rubbing && out; ++c) {
    const int frame = carrier(rubbing.cells[c].b).frame;
    out = carrier(rubbing.cells[c].a).frame < 0 &&
          (frame < 0 || !frames[static_cast<std::size_t>(frame)]->in_state());
  }
  return out;
}

void ContactForce::Impl::group_samples() {
  groups.clear();
  for (Pair& pair : pairs) {
    const auto own = std::span(samples).subspan(pair.begin, pair.end - pair.begin);
    pair.grouped = pair.law.friction == 0.0 && !pair.follows &&
                   std::all_of(own.begin(), own.end(),
                               [](const ContactSample& s) { return s.a.frame < 0 && s.stored == 1.0; });
    pair.given = !own.empty() && std::all_of(own.begin(), own.end(), [&](const ContactSample& s) {
      const auto is_given = [&](const SurfacePoint& p) {
        return p.frame >= 0 && !frames[static_cast<std::size_t>(p.frame)]->in_state();
      };
      return is_given(s.a) && is_given(s.b);
    });
    if (pair.grouped) groups.append(own, pair.law);
    const PressureLaw& own_law =
        laws_kept.empty() ? pair.law : laws_kept[static_cast<std::size_t>(&pair - pairs.data())];
    pair.in_cells = own_law.secant_friction && can_rub_in_cells(pair);
    if (pair.in_cells) friction_cells.append(rubbing, pair.first_rubbing, pair.last_rubbing, pair.law);
    if (pair.first_cell < pair.last_cell) groups.append(cells, pair.first_cell, pair.last_cell, pair.law);
  }
}

void ContactForce::Impl::check_samples(const dynamics::StateView& state) const {
  const int frame_count = static_cast<int>(frames.size()), node_count = state.layout->node_count();
  const auto check = [&](const auto& p) {
    PALPATE_CHECK(p.frame < frame_count && (p.frame >= 0 || (p.count > 0 && p.count <= 4)),
                  "contact sample: frame {} of {}, {} nodes", p.frame, frame_count, p.count);
    for (int i = 0; p.frame < 0 && i < p.count; ++i)
      PALPATE_CHECK(p.node[static_cast<std::size_t>(i)] < node_count, "contact sample: node {} of {}",
                    p.node[static_cast<std::size_t>(i)], node_count);
  };
  for (const Pair& pair : pairs)
    for (std::size_t i = pair.begin; i < pair.end && pair.first_rubbing == pair.last_rubbing; ++i) {
      const ContactSample& s = samples[i];
      check(s.a);
      check(s.b);
      PALPATE_CHECK(s.area >= 0.0 && s.normal.allFinite(), "contact sample: area {}", s.area);
    }
  for (const SampleCells* of : {&cells, &rubbing})
    for (const ContactCell& cell : of->cells) {
      check(of->carriers[static_cast<std::size_t>(cell.a)]);
      check(of->carriers[static_cast<std::size_t>(cell.b)]);
      PALPATE_CHECK(cell.normal.allFinite(), "contact cell: a normal is not finite");
    }
}

}  // namespace palpate::contact
