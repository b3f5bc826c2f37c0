#pragma once
#include <span>
#include <utility>
#include <vector>

#include "proxy/pruner.h"

/// Data shared by pruner.cpp (pairs and patches) and pruner_regions.cpp (planes and faces).  The method is
/// derived in pruner.cpp.
namespace palpate::proxy {

/// Skin kept on one side: sum of its area vectors, and its area.
struct SkinOrientation {
  Vec3 area = Vec3::Zero();
  double size = 0.0;
  void add(const Vec3& patch) {
    area += patch;
    size += patch.norm();
  }
  void add(const SkinOrientation& other) {
    area += other.area;
    size += other.size;
  }
  /// Whether the skin has a common direction, as skin in contact has.  False for the skin of an enclosed
  /// body, which is kept all around, and for no skin.
  bool directed() const { return area.norm() > 0.5 * size; }
};

/// Returns D; zero if one of the two has no skin.
inline Vec3 facing(const SkinOrientation& a, const SkinOrientation& b) {
  return a.size > 0.0 && b.size > 0.0 ? Vec3(b.area / b.size - a.area / a.size) : Vec3(Vec3::Zero());
}
/// |D| is 2 for flat skins that face each other and 0 for enclosed skin; above kClear it counts as a
/// direction.
inline constexpr double kClear = 1.0;

/// One body of the query: data of its patches, filled as they are tested.
struct Side {
  const ProxySet& set;
  std::span<const SkinPatch> patches;
  std::vector<Ball> balls;
  std::vector<Vec3> areas;
  std::vector<long> measured_at;        // per patch
  std::vector<unsigned char> kept;      // per patch, in this query
  std::vector<SkinOrientation> facing;  // per proxy, of its kept skin
  std::vector<long> facing_at;

  explicit Side(const ProxySet& s)
      : set(s),
        patches(s.patches()),
        balls(patches.size()),
        areas(balls.size()),
        measured_at(balls.size(), -1),
        kept(balls.size(), 0),
        facing(static_cast<std::size_t>(s.size())),
        facing_at(facing.size(), -1) {}
  /// Returns the index of the proxy's first patch.
  int first(int proxy) const { return static_cast<int>(set.patches(proxy).data() - patches.data()); }
  /// Computes ball and area of a patch, once per query.
  void measure(std::size_t patch, long query) {
    if (std::exchange(measured_at[patch], query) == query) return;
    balls[patch] = set.ball(patches[patch]);
    areas[patch] = set.area(patches[patch]);
  }
  /// Returns the proxy's kept skin, reset at the first call of a query.
  SkinOrientation& facing_of(int proxy, long query) {
    const auto at = static_cast<std::size_t>(proxy);
    if (std::exchange(facing_at[at], query) != query) facing[at] = {};
    return facing[at];
  }
};

/// Proxies of a and b that may be in contact.
struct Pair {
  int a, b;
};

/// Kept skin of one proxy of a, and of all proxies of b paired with it.
struct Active {
  int proxy;
  SkinOrientation a, b;
  int region = -1;
  Vec3 direction() const { return facing(a, b); }
};

struct Pruner::Impl {
  PruneOptions options;
  PruneCounts counts;
  RegionFinder finder;
  Side a, b;
  double gap = 0.0, time = 0.0;
  Reach whole_reach;  // between any proxy of a and any of b
  long pass = 0;  // counts queries and look-backs; the stamp in `measured_at`, `facing_at` and `claimed_a`
  // Per pair: the last direction that proved its proxies apart, or that the search ended with; zero: none.
  std::vector<Vec3> separating;
  std::vector<Vec3> last_normal;  // per proxy of a
  std::vector<long> last_query;
  std::vector<Pair> pairs;
  std::vector<Active> active;
  std::vector<int> open, near;
  // Per patch: query that added it as opposite skin; region (numbered over all queries) that holds it.
  std::vector<long> claimed_a, in_region_b;
  std::vector<int> order, proxies_a, proxies_b, patches_a, patches_b;
  Points corners_a, corners_b;  // capacity for a whole body; the first `count` columns are in use
  Eigen::Index count_a = 0, count_b = 0;
  std::vector<ContactRegion> regions;  // the first `used` belong to the last query
  std::size_t used = 0;
  long serial = 0;
  bool faces_a = false, faces_b = false;  // SkinOrientation::directed of the current region

  Impl(const ProxySet& set_a, const ProxySet& set_b, const PruneOptions& given)
      : options(given),
        a(set_a),
        b(set_b),
        separating(static_cast<std::size_t>(set_a.size()) * static_cast<std::size_t>(set_b.size()),
                   Vec3::Zero()),
        last_normal(static_cast<std::size_t>(set_a.size()), Vec3::Zero()),
        last_query(static_cast<std::size_t>(set_a.size()), -2),
        claimed_a(set_a.patches().size(), -1),
        in_region_b(set_b.patches().size(), -1),
        corners_a(room(set_a)),
        corners_b(room(set_b)) {}
  static Points room(const ProxySet& set) {
    Eigen::Index count = 0;
    for (int p = 0; p < set.size(); ++p) count += set.corner_count(p);
    return Points::Zero(3, count);
  }

  /// Returns the reach of proxy p of a relative to proxy q of b.
  Reach reach(int p, int q) const { return {gap, time, a.set.motion(p), b.set.motion(q)}; }
  /// Finds the pairs of proxies that are not proven apart.
  void find_pairs(double new_gap, double new_time);
  void visit(int x, int y);
  void test_pair(int p, int q);
  void keep_patches(Side& side, int own, const Side& other, int against, const Reach& reach,
                    const Vec3& toward);
  void keep_patches_of(const Pair& pair);
  Vec3& separating_of(int p, int q) {
    return separating[static_cast<std::size_t>(p) * static_cast<std::size_t>(b.set.size()) +
                      static_cast<std::size_t>(q)];
  }
  void collect();
  bool linked(int p, int p2) const;
  /// Grows a region from a seed (pruner_regions.cpp).
  void grow(std::size_t seed, int region);
  double gather(const Side& side, const std::vector<int>& proxies, Points& corners,
                Eigen::Index& count) const;
  void turn_to(Region& region, const Vec3& n, RegionMethod method) const;
  void measure_approach(ContactRegion& region, double inexact) const;
  /// Finds pairs and plane of a region; false: proven apart.
  bool find_plane(int number, ContactRegion& region);
  template <class Take>
  void add_facing_patches(Side& from, const std::vector<int>& from_patches, Side& to,
                          const ContactRegion& region, double sign, Take take);
  /// Fills in the faces and the extent of a region.
  void fill(ContactRegion& region);
  void remember(ContactRegion& region);
};

}  // namespace palpate::proxy
