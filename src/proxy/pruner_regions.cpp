#include <algorithm>
#include <cmath>
#include <limits>

#include "proxy/pruner_impl.h"

namespace palpate::proxy {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

/// Whether two proxies of a touch b next to each other: they are neighbours, and so are their partners in b.
bool Pruner::Impl::linked(int p, int p2) const {
  if (!a.set.neighbours(p, p2)) return false;
  const auto less = [](const Pair& pair, int proxy) { return pair.a < proxy; };
  const auto begin = std::lower_bound(pairs.begin(), pairs.end(), p, less),
             begin2 = std::lower_bound(pairs.begin(), pairs.end(), p2, less);
  for (auto i = begin; i != pairs.end() && i->a == p; ++i)
    for (auto j = begin2; j != pairs.end() && j->a == p2; ++j)
      if (b.set.neighbours(i->b, j->b)) return true;
  return false;
}

/// Grows a region from a seed: all contacts that are linked to it, step by step, and face the seed's
/// direction. Enclosed skin, which faces all directions, agrees with every direction.
void Pruner::Impl::grow(std::size_t seed, int region) {
  const Vec3 direction = active[seed].direction();
  const auto agrees = [&](const Active& other) {
    const Vec3 d = other.direction();
    return d.norm() < kClear || direction.norm() < kClear ||
           d.dot(direction) >= std::cos(options.merge_angle_rad) * d.norm() * direction.norm();
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

/// Copies the corners of some proxies into the first columns; returns their largest inflation.
double Pruner::Impl::gather(const Side& side, const std::vector<int>& proxies, Points& corners,
                            Eigen::Index& at) const {
  double inflation = 0.0;
  at = 0;
  for (const int p : proxies) {
    side.set.copy_corners(p, corners.middleCols(at, side.set.corner_count(p)));
    at += side.set.corner_count(p);
    inflation = std::max(inflation, side.set.state(p).inflation);
  }
  return inflation;
}

/// Recomputes the region's plane along another normal.
void Pruner::Impl::turn_to(Region& region, const Vec3& n, RegionMethod method) const {
  Eigen::Index lowest = 0, highest = 0;
  region.depth = -n.transpose().lazyProduct(corners_a.leftCols(count_a)).minCoeff(&lowest) +
                 n.transpose().lazyProduct(corners_b.leftCols(count_b)).maxCoeff(&highest);
  region.origin = 0.5 * (corners_a.col(lowest) + corners_b.col(highest));
  region.normal = n;
  region.method = method;
}

/// Computes gap, closing speed, distance and thickness from the region's proxies, along its normal.
void Pruner::Impl::measure_approach(ContactRegion& region, double inexact) const {
  const Vec3& n = region.region.normal;
  region.gap = gap;
  region.approach = 0.0;
  region.apart = std::max(0.0, -region.region.depth - inexact);
  region.thickness = kInfinity;
  for (const auto& [p, q] : region.pairs) {
    const ProxyMotion &of_p = a.set.motion(p), &of_q = b.set.motion(q);
    region.gap = std::max(region.gap, reach(p, q).along(n));
    region.approach =
        std::max(region.approach, of_p.spread + of_q.spread - n.dot(of_p.velocity - of_q.velocity));
  }
  for (const int p : proxies_a) region.thickness = std::min(region.thickness, a.set.rest_thickness(p));
  for (const int q : proxies_b) region.thickness = std::min(region.thickness, b.set.rest_thickness(q));
}

/// Finds pairs and plane of a region; returns false when the hulls of all its proxies together are proven
/// apart.
bool Pruner::Impl::find_plane(int number, ContactRegion& region) {
  constexpr double kSameSide = 0.5;
  region.pairs.clear();
  proxies_a.clear();
  proxies_b.clear();
  SkinOrientation facing_a, facing_b;
  finder.forget();
  for (const Active& one : active) {
    if (one.region != number) continue;
    proxies_a.push_back(one.proxy);
    facing_a.add(one.a);
    facing_b.add(one.b);
    if (const Vec3& last = last_normal[static_cast<std::size_t>(one.proxy)];
        proxies_a.size() == 1 && !last.isZero())
      finder.remember(last);
    for (const Pair& pair : pairs)
      if (pair.a == one.proxy) {
        region.pairs.emplace_back(pair.a, pair.b);
        proxies_b.push_back(pair.b);
      }
  }
  std::sort(proxies_b.begin(), proxies_b.end());
  proxies_b.erase(std::unique(proxies_b.begin(), proxies_b.end()), proxies_b.end());
  const double inflation_a = gather(a, proxies_a, corners_a, count_a),
               inflation_b = gather(b, proxies_b, corners_b, count_b);
  const double inexact = inflation_a + inflation_b;
  region.facing = facing(facing_a, facing_b);
  faces_a = facing_a.directed();
  faces_b = facing_b.directed();
  const bool is_clear = region.facing.norm() >= kClear;
  if (is_clear) turn_to(region.region, region.facing.normalized(), RegionMethod::kAreas);
  // Otherwise the hulls cannot give a more accurate normal.
  if (!is_clear || region.region.depth > inexact) {
    double margin = gap;
    for (const auto& [p, q] : region.pairs) margin = std::max(margin, reach(p, q).in_any_direction());
    const Region by_hulls =
        finder.find(corners_a.leftCols(count_a), corners_b.leftCols(count_b), inexact + margin);
    if (!by_hulls.found) return false;
    const Vec3& last = last_normal[static_cast<std::size_t>(proxies_a.front())];
    if (is_clear ? by_hulls.depth < region.region.depth - inexact &&
                       by_hulls.normal.dot(region.region.normal) > kSameSide
                 : last.isZero())
      region.region = by_hulls;
    else if (!is_clear)
      turn_to(region.region, last, RegionMethod::kLastNormal);
  }
  measure_approach(region, inexact);
  if (region.region.depth < -inexact - region.gap) return false;
  region.region.found = true;
  counts.regions_ahead += region.apart > gap;
  const RegionMethod by = region.region.method;
  ++(by == RegionMethod::kAreas        ? counts.normals_by_areas
     : by == RegionMethod::kLastNormal ? counts.normals_kept
                                       : counts.normals_by_hulls);
  const Vec3& n = region.region.normal;
  region.axes.col(0) = n.unitOrthogonal();
  region.axes.col(1) = n.cross(region.axes.col(0));
  region.axes.col(2) = n;
  return true;
}

/// Adds the patches of `to` that are opposite skin to `from` (see the top of pruner.cpp).
/// @param sign  +1 from a up to b, along the normal; -1 from b down to a
/// @param take  called for each such patch; adds it unless it is already in a region
template <class Take>
void Pruner::Impl::add_facing_patches(Side& from, const std::vector<int>& from_patches, Side& to,
                                      const ContactRegion& region, double sign, Take take) {
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
    return sign * place.z() + radius < lowest || ((place.head<2>() - high).array() > radius).any() ||
           ((low - place.head<2>()).array() > radius).any();
  };
  for (int q = 0; q < to.set.size(); ++q) {
    const ProxyState& hull = to.set.state(q);
    if (misses(0.5 * (hull.low + hull.high), 0.5 * (hull.high - hull.low).norm())) continue;
    for (int s = to.first(q); s < to.first(q) + static_cast<int>(to.set.patches(q).size()); ++s) {
      const auto at = static_cast<std::size_t>(s);
      to.measure(at, pass);
      if (to.areas[at].dot(up) > 0.0 && !misses(to.balls[at].centre, to.balls[at].radius)) take(s);
    }
  }
}

/// Fills in patches, faces and extent once the plane is known.
void Pruner::Impl::fill(ContactRegion& region) {
  patches_a.clear();
  patches_b.clear();
  ++serial;
  for (const int p : proxies_a)
    for (int s = a.first(p); s < a.first(p) + static_cast<int>(a.set.patches(p).size()); ++s)
      if (a.kept[static_cast<std::size_t>(s)]) patches_a.push_back(s);
  for (const int q : proxies_b)
    for (int s = b.first(q); s < b.first(q) + static_cast<int>(b.set.patches(q).size()); ++s)
      if (b.kept[static_cast<std::size_t>(s)]) {
        in_region_b[static_cast<std::size_t>(s)] = serial;
        patches_b.push_back(s);
      }
  const std::size_t kept_b = patches_b.size();
  if (!faces_b)
    add_facing_patches(a, patches_a, b, region, 1.0, [&](int s) {
      if (std::exchange(in_region_b[static_cast<std::size_t>(s)], serial) != serial) patches_b.push_back(s);
    });
  if (!faces_a) {
    open.assign(patches_b.begin(), patches_b.begin() + static_cast<std::ptrdiff_t>(kept_b));
    add_facing_patches(b, open, a, region, -1.0, [&](int s) {
      const auto at = static_cast<std::size_t>(s);
      if (!a.kept[at] && std::exchange(claimed_a[at], pass) != pass) patches_a.push_back(s);
    });
  }

  const auto extent = [&](const Side& side, const std::vector<int>& patches, std::vector<int>& faces,
                          Vec3& low, Vec3& high) {
    low.setConstant(kInfinity);
    high.setConstant(-kInfinity);
    faces.clear();
    for (const int s : patches) {
      const auto at = static_cast<std::size_t>(s);
      const Vec3 place = region.axes.transpose() * (side.balls[at].centre - region.region.origin);
      low = low.cwiseMin((place.array() - side.balls[at].radius).matrix());
      high = high.cwiseMax((place.array() + side.balls[at].radius).matrix());
      const auto list = side.set.faces(side.patches[at]);
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

/// Stores the region's normal for its proxies, and its rotation relative to the last query.
void Pruner::Impl::remember(ContactRegion& region) {
  region.rotation = 0.0;
  for (const int p : proxies_a) {
    const auto at = static_cast<std::size_t>(p);
    if (last_query[at] == counts.queries - 1)
      region.rotation =
          std::max(region.rotation, std::atan2(last_normal[at].cross(region.region.normal).norm(),
                                               last_normal[at].dot(region.region.normal)));
    last_query[at] = counts.queries;
    last_normal[at] = region.region.normal;
  }
  counts.largest_rotation = std::max(counts.largest_rotation, region.rotation);
}

}  // namespace palpate::proxy
