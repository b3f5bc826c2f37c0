// Completeness.  The inflated hulls of each body cover its skin and its inside (proxy_set.cpp).  A point of
// a's skin that is inside b, or nearer to it than the gap, lies in a face of one patch of one proxy i, and
// within the gap of an inflated hull j of b.  So the boxes of i and j come within the gap, no direction
// proves i and j farther apart than the sum of their inflations and the gap, and none proves the patch's ball
// farther from j than that: (i, j) stays a pair and the patch stays.  Each step excludes only pairs that
// a checked inequality proves to be far.  With a and b exchanged the same holds for b's skin.
//
// Opposite skin.  A point of a inside b is paired with the point of b's skin above it along the normal. If
// that point is inside a, its patch is kept by the rule above.  If not, a is enclosed by b there: the line
// upwards exits a before it exits b, through skin of a that faces up inside b.  For each kept patch of a that
// faces up, b's patches above it that face up are therefore added (`add_facing_patches`), and vice versa with
// a and b exchanged.  This is done only where the kept skin of the side to be added to has no common
// direction: where it has one, the line enters through that skin, neither body is enclosed, and the skin
// beyond is the far side of a body that holds the other from two sides; the line must not be paired with it.
//
// Motion.  Both bodies move until the next query, and `Reach` bounds the motion of a point of proxy i
// relative to one of proxy j (reach.h).  Each inequality above is evaluated with that bound: two points
// farther apart along a direction u than reach.along(u) do not come to touch.  So a face that comes to touch
// at the present velocities is in a region although it is apart now, or although the body would be beyond the
// other at the next query; and a fast proxy does not add candidates to the other proxies.
//
// No double counting.  Every face of a belongs to one patch, the patch to one proxy i, and all kept
// patches of i go into one region: the faces of a are divided among the regions.  The force is an integral
// over a's skin (each point against b's surface along its region's normal), so each point of a contributes
// once, however b's side is shared, and however either body is cut into proxies.
//
// Jumps.  A patch that enters or leaves is farther away than the gap, so that no force changes with it.  When
// patches enter or leave, and when regions merge or split, the normal jumps by the angle phi, which
// `rotation` and `largest_rotation` report.  Regions merge when the directions that their skins face differ
// by less than the merge angle, which determines the number of images.
//
// Shared planes.  The resultant of a uniform pressure on the part of a's skin inside b is minus its area
// vector, which by the divergence theorem is the area vector of b's skin inside a.  Both give the
// direction of the contact force, D = -A_a / |A_a|_1 + A_b / |A_b|_1 with area vectors A and areas |A|_1 of
// the kept patches.  Neighbours (with neighbours) whose D agree make one region, and D over all of it is its
// normal. As an integral over the skin, D is independent of how the bodies are cut, and moves as they move,
// whereas the normals of coarse hulls jump from facet to facet.  If libccd's normal on the same side is
// better by more than the inexactness of the hulls (their inflation: flat faces), it replaces D.  If there is
// no D (one body's skin is far from the other's, or encloses it), the normal stays what it was at the last
// query, the side that the bodies came from; if they never met before, it is libccd's normal for the hull of
// all the region's proxies together, in which the walls between a body's proxies are not surfaces.  A region
// whose hulls are proven apart along its normal ends.
#include "proxy/pruner.h"

#include <algorithm>
#include <cmath>

#include "core/counters.h"
#include "palpate/core/error.h"
#include "proxy/apart.h"
#include "proxy/pruner_impl.h"

namespace palpate::proxy {
namespace {

bool boxes_apart(const Vec3& low_a, const Vec3& high_a, const Vec3& low_b, const Vec3& high_b,
                 const Reach& reach) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 up = Vec3::Unit(axis), down = -up;
    if (low_a[axis] - high_b[axis] > reach.along(up) || low_b[axis] - high_a[axis] > reach.along(down))
      return true;
  }
  return false;
}

}  // namespace

/// Traverses both trees from the root down, splitting the larger branch first.
void Pruner::Impl::visit(int x, int y) {
  const auto tree_a = a.set.tree(), tree_b = b.set.tree();
  const ProxyBranch &branch_a = tree_a[static_cast<std::size_t>(x)],
                    &branch_b = tree_b[static_cast<std::size_t>(y)];
  ++counts.boxes_tested;
  if (boxes_apart(branch_a.low, branch_a.high, branch_b.low, branch_b.high, whole_reach)) return;
  if (branch_a.proxy >= 0 && branch_b.proxy >= 0) return test_pair(branch_a.proxy, branch_b.proxy);
  const bool open_a =
      branch_b.proxy >= 0 || (branch_a.proxy < 0 && (branch_a.high - branch_a.low).squaredNorm() >=
                                                        (branch_b.high - branch_b.low).squaredNorm());
  if (open_a)
    for (int child = x + 1; child < branch_a.after; child = tree_a[static_cast<std::size_t>(child)].after)
      visit(child, y);
  else
    for (int child = y + 1; child < branch_b.after; child = tree_b[static_cast<std::size_t>(child)].after)
      visit(x, child);
}

void Pruner::Impl::test_pair(int p, int q) {
  const ProxyState &hull_a = a.set.state(p), &hull_b = b.set.state(q);
  const Reach within = reach(p, q);
  if (boxes_apart(hull_a.low, hull_a.high, hull_b.low, hull_b.high, within)) return;
  ++counts.after_boxes;
  bool by_memory = false;
  if (apart(a.set, p, b.set, q, hull_a.inflation + hull_b.inflation, within, separating_of(p, q),
            by_memory)) {
    ++(by_memory ? counts.apart_by_memory : counts.apart_by_search);
    return;
  }
  ++counts.after_hulls;
  pairs.push_back({p, q});
}

void Pruner::Impl::find_pairs(double new_gap, double new_time) {
  gap = new_gap;
  time = new_time;
  whole_reach = {gap, time, a.set.widest_motion(), b.set.widest_motion()};
  ++pass;
  pairs.clear();
  for (Side* side : {&a, &b}) std::fill(side->kept.begin(), side->kept.end(), static_cast<unsigned char>(0));
  visit(0, 0);
}

/// Keeps the patches of `own` that may come within reach of the inflated hull `against`.  Patches that only
/// motion brings there count towards the direction of the contact only if they face the motion: the other
/// body cannot enter through trailing skin.
void Pruner::Impl::keep_patches(Side& side, int own, const Side& other, int against, const Reach& reach,
                                const Vec3& toward) {
  SkinOrientation& facing = side.facing_of(own, pass);
  const auto keep = [&](const Reach& within, bool by_motion) {
    counts.patches_tested += static_cast<long>(side.set.patches(own).size());
    side.set.patches_near(own, other.set, against, within, toward, side.kept, near);
    for (const int patch : near) {
      const auto at = static_cast<std::size_t>(patch);
      side.measure(at, pass);
      side.kept[at] = 1;
      ++counts.patches_kept;
      if (!by_motion || side.areas[at].dot(within.drift) > 0.0) facing.add(side.areas[at]);
    }
  };
  keep(Reach(reach.without_drift()), false);
  if (reach.is_moving()) keep(reach, true);
}

void Pruner::Impl::keep_patches_of(const Pair& pair) {
  const Vec3& direction = separating_of(pair.a, pair.b);
  const Reach within = reach(pair.a, pair.b);
  keep_patches(a, pair.a, b, pair.b, within, direction);
  keep_patches(b, pair.b, a, pair.a, within.from_other(), -direction);
}

/// Reduces the pairs to those that have kept patches, and sums the kept skin per proxy of a.
void Pruner::Impl::collect() {
  for (const Pair& pair : pairs) keep_patches_of(pair);
  std::erase_if(pairs, [&](const Pair& pair) {
    return a.facing_of(pair.a, pass).size == 0.0 && b.facing_of(pair.b, pass).size == 0.0;
  });
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& p, const Pair& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); });
  active.clear();
  for (const Pair& pair : pairs) {
    if (active.empty() || active.back().proxy != pair.a)
      active.push_back({pair.a, a.facing_of(pair.a, pass), {}, -1});
    active.back().b.add(b.facing_of(pair.b, pass));
  }
}

Pruner::Pruner(const ProxySet& a, const ProxySet& b, const PruneOptions& options)
    : impl_(std::make_unique<Impl>(a, b, options)) {
  counters::count("proxy.pruner");
  if (!(options.merge_angle_rad >= 0.0 && options.merge_angle_rad <= 3.2))
    fail("contact regions: merge angle = {} rad must lie between 0 and pi", options.merge_angle_rad);
  impl_->counts.pairs = static_cast<long>(a.size()) * b.size();
}
Pruner::~Pruner() = default;
Pruner::Pruner(Pruner&&) noexcept = default;

std::span<const ContactRegion> Pruner::query(double gap, double time) {
  Impl& s = *impl_;
  PALPATE_CHECK(gap >= 0.0 && time >= 0.0, "contact regions: gap = {} m and time = {} s must not be negative",
                gap, time);
  ++s.counts.queries;
  s.used = 0;
  s.find_pairs(gap, time);
  s.collect();

  s.order.resize(s.active.size());
  for (std::size_t i = 0; i < s.order.size(); ++i) s.order[i] = static_cast<int>(i);
  const auto clear = [&](int i) {  // large and flat
    const Active& one = s.active[static_cast<std::size_t>(i)];
    return one.a.size * std::pow(one.direction().norm(), 4);
  };
  // Regions grow from the clearest contact first.
  std::sort(s.order.begin(), s.order.end(),
            [&](int i, int j) { return clear(i) != clear(j) ? clear(i) > clear(j) : i < j; });
  int number = 0;
  for (const int seed : s.order) {
    if (s.active[static_cast<std::size_t>(seed)].region >= 0) continue;
    s.grow(static_cast<std::size_t>(seed), number);
    if (s.used == s.regions.size()) s.regions.emplace_back();
    ContactRegion& region = s.regions[s.used];
    if (!s.find_plane(number++, region)) {
      ++s.counts.regions_apart;
      continue;
    }
    s.fill(region);
    s.remember(region);
    ++s.counts.regions;
    ++s.used;
  }
  return {s.regions.data(), s.used};
}

void Pruner::met_on_the_way(std::vector<int>& faces_a, std::vector<int>& faces_b) {
  constexpr double kPart = 0.25;
  Impl& s = *impl_;
  faces_a.clear();
  faces_b.clear();
  const PruneCounts before = s.counts;  // the counts are of queries only
  const auto may_pass = [](const ProxyMotion& p, double thickness_p, const ProxyMotion& q,
                           double thickness_q) {
    return (p.velocity - q.velocity).norm() + p.spread + q.spread >
           kPart * std::min(thickness_p, thickness_q);
  };
  const ProxySet &a = s.a.set, &b = s.b.set;
  if (!may_pass(a.motion(), a.rest_thickness(), b.motion(), b.rest_thickness())) return;
  s.find_pairs(0.0, -1.0);  // backwards along the displacement
  const bool through = std::any_of(s.pairs.begin(), s.pairs.end(), [&](const Pair& pair) {
    return may_pass(a.motion(pair.a), a.rest_thickness(pair.a), b.motion(pair.b), b.rest_thickness(pair.b));
  });
  if (through) {
    for (const Pair& pair : s.pairs) s.keep_patches_of(pair);
    const auto gather = [](const Side& side, std::vector<int>& faces) {
      for (std::size_t patch = 0; patch < side.kept.size(); ++patch)
        if (side.kept[patch]) {
          const auto list = side.set.faces(side.patches[patch]);
          faces.insert(faces.end(), list.begin(), list.end());
        }
    };
    gather(s.a, faces_a);
    gather(s.b, faces_b);
  }
  s.counts = before;
}

// Separating directions are not archived: each is proven anew, or found.
void Pruner::archive(Archive& a) {
  Impl& s = *impl_;
  PruneCounts& c = s.counts;
  for (auto& [name, count] :
       std::initializer_list<std::pair<const char*, long&>>{{"queries", c.queries},
                                                            {"boxes_tested", c.boxes_tested},
                                                            {"after_boxes", c.after_boxes},
                                                            {"apart_by_memory", c.apart_by_memory},
                                                            {"apart_by_search", c.apart_by_search},
                                                            {"after_hulls", c.after_hulls},
                                                            {"patches_tested", c.patches_tested},
                                                            {"patches_kept", c.patches_kept},
                                                            {"regions", c.regions},
                                                            {"regions_apart", c.regions_apart},
                                                            {"regions_ahead", c.regions_ahead},
                                                            {"normals_by_areas", c.normals_by_areas},
                                                            {"normals_kept", c.normals_kept},
                                                            {"normals_by_hulls", c.normals_by_hulls},
                                                            {"faces_a", c.faces_a},
                                                            {"faces_b", c.faces_b}})
    a(name, count);
  a("largest_rotation", c.largest_rotation);
  a.rows("last_normal", s.last_normal, [](auto&& f, Vec3& normal) { f(normal); });
  a.rows("last_query", s.last_query, [](auto&& f, long& query) { f(query); });
}

const PruneCounts& Pruner::counts() const { return impl_->counts; }

}  // namespace palpate::proxy
