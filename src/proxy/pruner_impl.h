#pragma once
#include <span>
#include <utility>
#include <vector>

#include "palpate/proxy/pruner.h"

/// What pruner.cpp (pairs and patches) and pruner_regions.cpp (planes and faces) work on;
/// the derivation stands in pruner.cpp.
namespace palpate::proxy {

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
  /// It faces one way, as skin in contact does;
  /// not skin of a enclosed body, which is kept all around, nor none.
  bool directed() const { return area.norm() > 0.5 * size; }
};

/// D; zero where one of them has no skin.
inline Vec3 facing(const Facing& a, const Facing& b) {
  return a.size > 0.0 && b.size > 0.0 ? Vec3(b.area / b.size - a.area / a.size) : Vec3(Vec3::Zero());
}
/// |D| of skins that face each other is 2, of enclosed skin 0; above this it is a direction
inline constexpr double kClear = 1.0;

/// One body of the query: its patches as far as they were tested.
struct Side {
  const ProxySet& set;
  std::span<const SkinPatch> patches;
  std::vector<Ball> balls;
  std::vector<Vec3> areas;
  std::vector<long> measured_at;    // by patch
  std::vector<unsigned char> kept;  // by patch, in this query
  std::vector<Facing> facing;       // by proxy, of what is kept of it
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
  int first(int proxy) const { return static_cast<int>(set.patches(proxy).data() - patches.data()); }
  void measure(std::size_t patch, long query) {
    if (std::exchange(measured_at[patch], query) == query) return;
    balls[patch] = set.ball(patches[patch]);
    areas[patch] = set.area(patches[patch]);
  }
  Facing& facing_of(int proxy, long query) {
    const auto at = static_cast<std::size_t>(proxy);
    if (std::exchange(facing_at[at], query) != query) facing[at] = {};
    return facing[at];
  }
};

struct Pair {
  int a, b;
};

/// What is kept of one proxy of a, against all of b.
struct Active {
  int proxy;
  Facing a, b;
  int region = -1;
  Vec3 direction() const { return facing(a, b); }
};

struct Pruner::Impl {
  PruneOptions options;
  PruneCounts counts;
  RegionFinder finder;
  Side a, b;
  double gap = 0.0, time = 0.0;
  Reach whole_reach;  // of any proxy of a against any of b
  long pass = 0;      // counts queries and looks back; what `measured_at` and the like refer to
  // by pair: the last direction that its proxies were found apart along,
  // or that the search ended with; zero for none
  std::vector<Vec3> separating;
  std::vector<Vec3> last_normal;  // by proxy of a
  std::vector<long> last_query;
  std::vector<Pair> pairs;
  std::vector<Active> active;
  std::vector<int> open, near;
  // by patch: the query that looked through to it; the region (counted over all queries) that has it
  std::vector<long> claimed_a, in_region_b;
  std::vector<int> order, proxies_a, proxies_b, patches_a, patches_b;
  Points corners_a, corners_b;  // room for all of a body; of the region at hand the first `count`
  Eigen::Index count_a = 0, count_b = 0;
  std::vector<ContactRegion> regions;  // the first `used` are the last query's
  std::size_t used = 0;
  long serial = 0;
  bool faces_a = false, faces_b = false;  // of the region at hand: Facing::directed

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

  Reach reach(int p, int q) const { return {gap, time, a.set.motion(p), b.set.motion(q)}; }
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
  void grow(std::size_t seed, int region);
  double gather(const Side& side, const std::vector<int>& proxies, Points& corners,
                Eigen::Index& count) const;
  void turn_to(Region& region, const Vec3& n, RegionMethod method) const;
  void measure_approach(ContactRegion& region, double inexact) const;
  bool find_plane(int number, ContactRegion& region);
  template <class Take>
  void add_facing_patches(Side& from, const std::vector<int>& from_patches, Side& to,
                          const ContactRegion& region, double sign, Take take);
  void fill(ContactRegion& region);
  void remember(ContactRegion& region);
};

}  // namespace palpate::proxy
