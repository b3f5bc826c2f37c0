// Nothing is lost.  The inflated hulls of each body cover its skin and its inside (proxy_set.cpp).  A point of a's skin that is inside b, or nearer to it than
// the gap, lies in a face of one patch of one proxy i, and within the gap of an inflated hull j of b.  So the boxes of i and j come within the gap, no
// direction proves i and j farther apart than the sum of their inflations and the gap, and none proves the patch's ball farther from j than that: (i, j)
// stays a pair and the patch stays.  Each step leaves out only what a checked inequality says is far.  With a and b exchanged the same holds for b's skin.
//
// What faces it.  Seen along the normal a point of a inside b is paired with the point of b's skin above it.  If that is inside a, it stays by the rule above.
// If not, a has been swallowed there: the way up leaves a before it leaves b, through skin of a that faces up inside b.  Under each kept patch of a that
// faces up, b's patches that face up, and are above, are taken in too (`look_through`), and the mirror image for b.
//
// Nothing is counted twice.  Every face of a belongs to one patch, that to one proxy i, and all that is kept of i goes into one region: the faces of a are
// divided among the regions.  The force is an integral over a's skin (each point against what b shows it along its region's normal), so each point of a
// contributes once, however b's side is shared, and however either body is cut into proxies.
//
// Jumps.  A patch that comes or goes is farther away than the gap: no force comes or goes with it.  What can jump is a normal: when region i's changes by the
// angle phi, its force F_i keeps its size to first order and turns, |dF_i| <= 2 sin(phi / 2) |F_i|.  Regions merge only when what their skins face differs
// by less than the merge angle.  `turned` and `largest_turn` report phi.
//
// Which proxies share a plane.  The resultant of a uniform pressure on the part of a's skin inside b is minus its area vector, which by the divergence theorem
// is the area vector of b's skin inside a: both say which way the contact pushes, D = -A_a / |A_a|_1 + A_b / |A_b|_1 with area vectors A and areas |A|_1 of
// the kept patches.  Neighbours (with neighbours) whose D agree make one region, and D over all of it is its normal: an integral over the skin, it does not
// know how the bodies are cut, and moves as they move, where the normals of coarse hulls go from facet to facet; but where libccd's normal on the same side is
// better by more than the hulls are inexact (their inflation: flat faces), that is taken.  Where there is no D (one body's skin is far from
// the other's, or all around it: swallowed) the normal stays what it was at the last query, the side that the bodies came from; and where they never met before, it
// is libccd's for the hull of all the region's proxies together, in which the walls between a body's own proxies are no surfaces.  That hull's verdict
// "apart", proven along its normal, ends the region in any case.
#include "palpate/proxy/pruner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "proxy/apart.h"

namespace palpate::proxy {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Skin kept on one side: its area vector and area.
struct Facing {
  Vec3 area = Vec3::Zero();
  double size = 0.0;
  void add(const Vec3& patch) {
    area += patch;
    size += patch.norm();
  }
  void add(const Facing& other) {
    area += other.area;
    size += other.size;
  }
};

/// D; zero where one of them has no skin.
Vec3 facing(const Facing& a, const Facing& b) {
  return a.size > 0.0 && b.size > 0.0 ? Vec3(b.area / b.size - a.area / a.size) : Vec3(Vec3::Zero());
}
constexpr double kClear = 1.0;  ///< |D| of skins that face each other is 2, of swallowed skin 0; above this it is a direction

/// One body of the query: its patches as far as they were looked at.
struct Side {
  const ProxySet& set;
  std::vector<Ball> balls;
  std::vector<Vec3> areas;
  std::vector<long> measured_at;  // by proxy
  std::vector<long> kept_at;      // by patch

  explicit Side(const ProxySet& s)
      : set(s), balls(s.patches().size()), areas(balls.size()), measured_at(static_cast<std::size_t>(s.size()), -1), kept_at(balls.size(), -1) {}
  int first(int proxy) const { return static_cast<int>(set.patches(proxy).data() - set.patches().data()); }
  void measure(int proxy, long query) {
    if (std::exchange(measured_at[static_cast<std::size_t>(proxy)], query) == query) return;
    auto at = static_cast<std::size_t>(first(proxy));
    for (const SkinPatch& patch : set.patches(proxy)) {
      balls[at] = set.ball(patch);
      areas[at++] = set.area(patch);
    }
  }
};

struct Pair {
  int a, b;
  Facing facing_a, facing_b;
};

/// What is kept of one proxy of a, against all of b.
struct Active {
  int proxy;
  Facing a, b;
  int region = -1;
  Vec3 direction() const { return facing(a, b); }
};

bool boxes_apart(const Vec3& low_a, const Vec3& high_a, const Vec3& low_b, const Vec3& high_b, double gap) {
  return ((low_a - high_b).array() > gap).any() || ((low_b - high_a).array() > gap).any();
}

}  // namespace

struct Pruner::Impl {
  PruneOptions options;
  PruneCounts counts;
  RegionFinder finder;
  Side a, b;
  double gap = 0.0;
  std::vector<Vec3> separating;      // by pair, zero for none
  std::vector<Vec3> last_normal;     // by proxy of a
  std::vector<long> last_query;
  std::vector<Pair> pairs;
  std::vector<Active> active;
  std::vector<int> open;
  std::vector<long> claimed_a, in_region_b;  // by patch: the query that looked through to it; the region (counted over all queries) that has it
  std::vector<int> order, proxies_a, proxies_b, patches_a, patches_b;
  Points corners_a, corners_b;
  std::vector<ContactRegion> regions;  // the first `used` are the last query's
  std::size_t used = 0;
  long serial = 0;

  Impl(const ProxySet& set_a, const ProxySet& set_b, const PruneOptions& given)
      : options(given), a(set_a), b(set_b), separating(static_cast<std::size_t>(set_a.size()) * static_cast<std::size_t>(set_b.size()), Vec3::Zero()),
        last_normal(static_cast<std::size_t>(set_a.size()), Vec3::Zero()), last_query(static_cast<std::size_t>(set_a.size()), -2),
        claimed_a(set_a.patches().size(), -1), in_region_b(set_b.patches().size(), -1) {}

  bool allowed(int p, int q) const {
    return !options.between_bones || (p < q && a.set.bone(p) != b.set.bone(q) && !a.set.neighbours(p, q));
  }
  void visit(int x, int y);
  void test_pair(int p, int q);
  void keep_patches(Side& side, int own, Side& other, int against, Facing& facing);
  void collect();
  bool linked(int p, int p2) const;
  void grow(std::size_t seed, int region);
  double gather(const Side& side, const std::vector<int>& proxies, Points& corners) const;
  void turn_to(Region& region, const Vec3& n, RegionMethod method) const;
  bool find_plane(int number, ContactRegion& region);
  template <class Take>
  void look_through(Side& from, const std::vector<int>& from_patches, Side& to, const ContactRegion& region, double sign, Take take);
  void fill(ContactRegion& region);
  void remember(ContactRegion& region);
};

/// Both trees from the root down, the larger branch first.
void Pruner::Impl::visit(int x, int y) {
  const auto tree_a = a.set.tree(), tree_b = b.set.tree();
  const ProxyBranch &branch_a = tree_a[static_cast<std::size_t>(x)], &branch_b = tree_b[static_cast<std::size_t>(y)];
  ++counts.boxes_tested;
  if (boxes_apart(branch_a.low, branch_a.high, branch_b.low, branch_b.high, gap)) return;
  if (branch_a.proxy >= 0 && branch_b.proxy >= 0) return test_pair(branch_a.proxy, branch_b.proxy);
  const bool open_a = branch_b.proxy >= 0 || (branch_a.proxy < 0 && (branch_a.high - branch_a.low).squaredNorm() >= (branch_b.high - branch_b.low).squaredNorm());
  if (open_a)
    for (int child = x + 1; child < branch_a.after; child = tree_a[static_cast<std::size_t>(child)].after) visit(child, y);
  else
    for (int child = y + 1; child < branch_b.after; child = tree_b[static_cast<std::size_t>(child)].after) visit(x, child);
}

void Pruner::Impl::test_pair(int p, int q) {
  if (!allowed(p, q)) return;
  ++counts.after_boxes;
  bool by_memory = false;
  const double margin = a.set.state(p).inflation + b.set.state(q).inflation + gap;
  Vec3& direction = separating[static_cast<std::size_t>(p) * static_cast<std::size_t>(b.set.size()) + static_cast<std::size_t>(q)];
  if (apart(a.set, p, b.set, q, margin, direction, by_memory)) {
    ++(by_memory ? counts.apart_by_memory : counts.apart_by_search);
    return;
  }
  ++counts.after_hulls;
  pairs.push_back({p, q, {}, {}});
}

/// The patches of `own` that may reach the inflated hull `against`.
void Pruner::Impl::keep_patches(Side& side, int own, Side& other, int against, Facing& facing) {
  side.measure(own, counts.queries);
  const ProxyState& hull = other.set.state(against);
  const int first = side.first(own), end = first + static_cast<int>(side.set.patches(own).size());
  for (int s = first; s < end; ++s) {
    const auto at = static_cast<std::size_t>(s);
    const Ball& ball = side.balls[at];
    ++counts.patches_tested;
    const double reach = ball.radius + gap;
    if (((hull.low - ball.centre).array() > reach).any() || ((ball.centre - hull.high).array() > reach).any()) continue;
    if (apart(ball, other.set, against, hull.inflation + gap)) continue;
    counts.patches_kept += std::exchange(side.kept_at[at], counts.queries) != counts.queries;
    facing.add(side.areas[at]);
  }
}

/// Pairs with skin to show, and what they make of each proxy of a.
void Pruner::Impl::collect() {
  for (Pair& pair : pairs) {
    keep_patches(a, pair.a, b, pair.b, pair.facing_a);
    keep_patches(b, pair.b, a, pair.a, pair.facing_b);
  }
  std::erase_if(pairs, [](const Pair& pair) { return pair.facing_a.size == 0.0 && pair.facing_b.size == 0.0; });
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); });
  active.clear();
  for (const Pair& pair : pairs) {
    if (active.empty() || active.back().proxy != pair.a) active.push_back({pair.a, {}, {}, -1});
    active.back().a.add(pair.facing_a);
    active.back().b.add(pair.facing_b);
  }
}

/// Two proxies of a touch b side by side: neighbours, with neighbours.
bool Pruner::Impl::linked(int p, int p2) const {
  if (!a.set.neighbours(p, p2)) return false;
  const auto less = [](const Pair& pair, int proxy) { return pair.a < proxy; };
  const auto begin = std::lower_bound(pairs.begin(), pairs.end(), p, less), begin2 = std::lower_bound(pairs.begin(), pairs.end(), p2, less);
  for (auto i = begin; i != pairs.end() && i->a == p; ++i)
    for (auto j = begin2; j != pairs.end() && j->a == p2; ++j)
      if (b.set.neighbours(i->b, j->b)) return true;
  return false;
}

/// The region of a seed: what is linked to it, step by step, and faces as it does.  Swallowed skin, which faces every way, faces with all.
void Pruner::Impl::grow(std::size_t seed, int region) {
  const Vec3 direction = active[seed].direction();
  const auto agrees = [&](const Active& other) {
    const Vec3 d = other.direction();
    return d.norm() < kClear || direction.norm() < kClear || d.dot(direction) >= std::cos(options.merge_angle_rad) * d.norm() * direction.norm();
  };
  active[seed].region = region;
  open.assign(1, static_cast<int>(seed));
  while (!open.empty()) {
    const int from = active[static_cast<std::size_t>(open.back())].proxy;
    open.pop_back();
    for (std::size_t i = 0; i < active.size(); ++i)
      if (active[i].region < 0 && linked(from, active[i].proxy) && agrees(active[i])) {
        active[i].region = region;
        open.push_back(static_cast<int>(i));
      }
  }
}

/// All corners of some proxies; returns the largest inflation among them.
double Pruner::Impl::gather(const Side& side, const std::vector<int>& proxies, Points& corners) const {
  Eigen::Index count = 0;
  for (const int p : proxies) count += side.set.corner_count(p);
  corners.resize(3, count);
  double inflation = 0.0;
  Eigen::Index at = 0;
  for (const int p : proxies) {
    side.set.copy_corners(p, corners.middleCols(at, side.set.corner_count(p)));
    at += side.set.corner_count(p);
    inflation = std::max(inflation, side.set.state(p).inflation);
  }
  return inflation;
}

/// The plane along another normal.
void Pruner::Impl::turn_to(Region& region, const Vec3& n, RegionMethod method) const {
  Eigen::Index lowest = 0, highest = 0;
  region.depth = -(n.transpose() * corners_a).minCoeff(&lowest) + (n.transpose() * corners_b).maxCoeff(&highest);
  region.origin = 0.5 * (corners_a.col(lowest) + corners_b.col(highest));
  region.normal = n;
  region.method = method;
}

/// Pairs and plane of a region; false when the hulls of all its proxies together are proven apart.
bool Pruner::Impl::find_plane(int number, ContactRegion& region) {
  constexpr double kSameSide = 0.5;
  region.pairs.clear();
  proxies_a.clear();
  proxies_b.clear();
  Facing facing_a, facing_b;
  finder.forget();
  for (const Active& one : active) {
    if (one.region != number) continue;
    proxies_a.push_back(one.proxy);
    facing_a.add(one.a);
    facing_b.add(one.b);
    if (const Vec3& last = last_normal[static_cast<std::size_t>(one.proxy)]; proxies_a.size() == 1 && !last.isZero()) finder.remember(last);
    for (const Pair& pair : pairs)
      if (pair.a == one.proxy) {
        region.pairs.emplace_back(pair.a, pair.b);
        proxies_b.push_back(pair.b);
      }
  }
  std::sort(proxies_b.begin(), proxies_b.end());
  proxies_b.erase(std::unique(proxies_b.begin(), proxies_b.end()), proxies_b.end());
  const double inflation_a = gather(a, proxies_a, corners_a), inflation_b = gather(b, proxies_b, corners_b);
  region.region = finder.find(corners_a, corners_b, inflation_a + inflation_b + gap);
  if (!region.region.found) return false;
  region.facing = facing(facing_a, facing_b);
  if (region.facing.norm() >= kClear) {
    const Region by_hulls = region.region;
    turn_to(region.region, region.facing.normalized(), RegionMethod::kAreas);
    if (by_hulls.depth < region.region.depth - inflation_a - inflation_b && by_hulls.normal.dot(region.region.normal) > kSameSide) region.region = by_hulls;
  } else if (const Vec3& last = last_normal[static_cast<std::size_t>(proxies_a.front())]; !last.isZero())
    turn_to(region.region, last, RegionMethod::kLastNormal);
  const RegionMethod by = region.region.method;
  ++(by == RegionMethod::kAreas ? counts.normals_by_areas : by == RegionMethod::kLastNormal ? counts.normals_kept : counts.normals_by_hulls);
  const Vec3& n = region.region.normal;
  region.axes.col(0) = n.unitOrthogonal();
  region.axes.col(1) = n.cross(region.axes.col(0));
  region.axes.col(2) = n;
  return true;
}

/// Patches of `to` that `from` sees through itself: see above.  sign: +1 from a up to b, along the normal; -1 from b down to a.  take(patch) says whether it is new.
template <class Take>
void Pruner::Impl::look_through(Side& from, const std::vector<int>& from_patches, Side& to, const ContactRegion& region, double sign, Take take) {
  constexpr double kFacesUp = 0.1;
  const Mat3 to_axes = region.axes.transpose();
  const Vec3 up = sign * region.region.normal, origin = region.region.origin;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(kInfinity), high = -low;
  double lowest = kInfinity;
  for (const int s : from_patches) {
    const auto at = static_cast<std::size_t>(s);
    if (!(from.areas[at].dot(up) > kFacesUp * from.areas[at].norm())) continue;
    const Vec3 place = to_axes * (from.balls[at].centre - origin);
    low = low.cwiseMin((place.head<2>().array() - from.balls[at].radius).matrix());
    high = high.cwiseMax((place.head<2>().array() + from.balls[at].radius).matrix());
    lowest = std::min(lowest, sign * place.z() - from.balls[at].radius);
  }
  if (!(low.x() <= high.x())) return;
  const auto misses = [&](const Vec3& centre, double radius) {
    const Vec3 place = to_axes * (centre - origin);
    return sign * place.z() + radius < lowest || ((place.head<2>() - high).array() > radius).any() || ((low - place.head<2>()).array() > radius).any();
  };
  for (int q = 0; q < to.set.size(); ++q) {
    const ProxyState& hull = to.set.state(q);
    if (misses(0.5 * (hull.low + hull.high), 0.5 * (hull.high - hull.low).norm())) continue;
    to.measure(q, counts.queries);
    for (int s = to.first(q); s < to.first(q) + static_cast<int>(to.set.patches(q).size()); ++s) {
      const auto at = static_cast<std::size_t>(s);
      if (to.areas[at].dot(up) > 0.0 && !misses(to.balls[at].centre, to.balls[at].radius)) take(s);
    }
  }
}

/// Patches, faces and extent, once the plane is known.
void Pruner::Impl::fill(ContactRegion& region) {
  patches_a.clear();
  patches_b.clear();
  ++serial;
  for (const int p : proxies_a)
    for (int s = a.first(p); s < a.first(p) + static_cast<int>(a.set.patches(p).size()); ++s)
      if (a.kept_at[static_cast<std::size_t>(s)] == counts.queries) patches_a.push_back(s);
  for (const int q : proxies_b)
    for (int s = b.first(q); s < b.first(q) + static_cast<int>(b.set.patches(q).size()); ++s)
      if (b.kept_at[static_cast<std::size_t>(s)] == counts.queries) {
        in_region_b[static_cast<std::size_t>(s)] = serial;
        patches_b.push_back(s);
      }
  const std::size_t kept_b = patches_b.size();
  look_through(a, patches_a, b, region, 1.0, [&](int s) {
    if (std::exchange(in_region_b[static_cast<std::size_t>(s)], serial) != serial) patches_b.push_back(s);
  });
  open.assign(patches_b.begin(), patches_b.begin() + static_cast<std::ptrdiff_t>(kept_b));
  look_through(b, open, a, region, -1.0, [&](int s) {
    const auto at = static_cast<std::size_t>(s);
    if (a.kept_at[at] != counts.queries && std::exchange(claimed_a[at], counts.queries) != counts.queries) patches_a.push_back(s);
  });

  const auto extent = [&](const Side& side, const std::vector<int>& patches, std::vector<int>& faces, Vec3& low, Vec3& high) {
    low.setConstant(kInfinity);
    high.setConstant(-kInfinity);
    faces.clear();
    for (const int s : patches) {
      const auto at = static_cast<std::size_t>(s);
      const Vec3 place = region.axes.transpose() * (side.balls[at].centre - region.region.origin);
      low = low.cwiseMin((place.array() - side.balls[at].radius).matrix());
      high = high.cwiseMax((place.array() + side.balls[at].radius).matrix());
      const auto list = side.set.faces(side.set.patches()[at]);
      faces.insert(faces.end(), list.begin(), list.end());
    }
  };
  Vec3 low_b, high_b;
  extent(a, patches_a, region.faces_a, region.low, region.high);
  extent(b, patches_b, region.faces_b, low_b, high_b);
  region.low.head<2>() = region.low.head<2>().cwiseMax(low_b.head<2>());
  region.high.head<2>() = region.high.head<2>().cwiseMin(high_b.head<2>());
  region.low.z() = std::min(region.low.z(), low_b.z());
  region.high.z() = std::max(region.high.z(), high_b.z());
  counts.faces_a += static_cast<long>(region.faces_a.size());
  counts.faces_b += static_cast<long>(region.faces_b.size());
}

/// Keeps the normal of the region's proxies, and how far it turned for those that had one at the last query.
void Pruner::Impl::remember(ContactRegion& region) {
  region.turned = 0.0;
  for (const int p : proxies_a) {
    const auto at = static_cast<std::size_t>(p);
    if (last_query[at] == counts.queries - 1)
      region.turned = std::max(region.turned, std::atan2(last_normal[at].cross(region.region.normal).norm(), last_normal[at].dot(region.region.normal)));
    last_query[at] = counts.queries;
    last_normal[at] = region.region.normal;
  }
  counts.largest_turn = std::max(counts.largest_turn, region.turned);
}

Pruner::Pruner(const ProxySet& a, const ProxySet& b, const PruneOptions& options) : impl_(std::make_unique<Impl>(a, b, options)) {
  counters::count("proxy.pruner");
  if (!(options.merge_angle_rad >= 0.0 && options.merge_angle_rad <= 3.2)) fail("contact regions: merge angle = {} rad must lie between 0 and pi", options.merge_angle_rad);
  PALPATE_CHECK(!options.between_bones || &a == &b, "contact between the bones of one body has that body on both sides");
  for (int p = 0; p < a.size(); ++p)
    for (int q = 0; q < b.size(); ++q) impl_->counts.pairs += impl_->allowed(p, q);
}
Pruner::~Pruner() = default;
Pruner::Pruner(Pruner&&) noexcept = default;

std::span<const ContactRegion> Pruner::query(double gap) {
  Impl& s = *impl_;
  PALPATE_CHECK(gap >= 0.0, "contact regions: gap = {} m", gap);
  s.gap = gap;
  ++s.counts.queries;
  s.used = 0;
  s.pairs.clear();
  s.visit(0, 0);
  s.collect();

  s.order.resize(s.active.size());
  for (std::size_t i = 0; i < s.order.size(); ++i) s.order[i] = static_cast<int>(i);
  const auto clear = [&](int i) {  // large and flat
    const Active& one = s.active[static_cast<std::size_t>(i)];
    return one.a.size * std::pow(one.direction().norm(), 4);
  };
  std::sort(s.order.begin(), s.order.end(), [&](int i, int j) { return clear(i) != clear(j) ? clear(i) > clear(j) : i < j; });  // the clearest contact first
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

const PruneCounts& Pruner::counts() const { return impl_->counts; }
const RegionCounts& Pruner::region_counts() const { return impl_->finder.counts(); }

}  // namespace palpate::proxy
