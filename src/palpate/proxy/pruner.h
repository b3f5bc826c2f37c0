#pragma once
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "palpate/core/archive.h"
#include "palpate/proxy/proxy_set.h"
#include "palpate/proxy/region.h"

namespace palpate::proxy {

struct PruneOptions {
  /// neighbouring contacts whose skins face each other along directions nearer than this share a plane
  double merge_angle_rad = 1.05;
};

/// One contact region of two bodies: the plane that its image is taken along,
/// and the skin that may take part.
struct ContactRegion {
  Region region;                 ///< normal from b to a, plane D
  Mat3 axes = Mat3::Identity();  ///< columns u, v, normal
  /// extent in these axes about region.origin: (u, v) where both sides have skin, w of all of it [m]
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  /// the direction that its skins face each other along, from b to a;
  /// 2 long where both are flat, 0 where one is enclosed
  Vec3 facing = Vec3::Zero();
  std::vector<std::pair<int, int>> pairs;  ///< proxies of a and b
  std::vector<int> faces_a, faces_b;       ///< faces of the skins, patch by patch
  /// largest angle between its normal and what any of its
  /// proxies of a had at the last query; 0 for new ones [rad]
  double rotation = 0.0;
  /// how far apart along the normal two points of its skins may be that come within the query's gap of each
  /// other until the next: at least that gap, and the way that its own proxies may close [m]
  double gap = 0.0;
  double approach = 0.0;   ///< bound on the speed at which they come nearer along the normal, 0 or more [m/s]
  double apart = 0.0;      ///< proven distance of its hulls along the normal, 0 or more [m]
  double thickness = 0.0;  ///< of its thinnest proxy, at rest [m]
};

/// Counts of tested and excluded pairs since the pruner was made.
struct PruneCounts {
  long queries = 0;
  long pairs = 0;            ///< of proxies
  long boxes_tested = 0;     ///< pairs of branches
  long after_boxes = 0;      ///< pairs of proxies whose boxes meet
  long apart_by_memory = 0;  ///< of those, proven apart by the direction that did it last time
  long apart_by_search = 0;  ///< proven apart by a new direction
  long after_hulls = 0;      ///< pairs of proxies that were not proven apart
  long patches_tested = 0, patches_kept = 0;  ///< balls of patches against hulls
  long regions = 0;
  long regions_apart = 0;  ///< proven apart as a whole, and left out
  long regions_ahead = 0;  ///< farther apart than the query's gap, but not out of reach
  /// regions by where their normal came from: the skins, the last query, libccd
  long normals_by_areas = 0, normals_kept = 0, normals_by_hulls = 0;
  long faces_a = 0, faces_b = 0;  ///< handed on, over all queries and regions
  double largest_rotation = 0.0;  ///< [rad]
};

/// Which skin of two bodies may be in contact, and in which regions.  How it decides, and why nothing is lost
/// or counted twice, stands in pruner.cpp.
///
/// Every face of a of which a point is nearer than `gap` to body b, or inside, or may come to touch it within
/// `time` at the present velocities (ProxySet::set_motion), is in exactly one region; every such face of b in
/// each region that holds a face of a which it may meet.
/// Directions and normals of the last query are kept, so the answer depends on the past where a normal is not
/// unique (deep overlap); the faces do not.
class Pruner {
 public:
  /// @pre both sets live longer
  Pruner(const ProxySet& a, const ProxySet& b, const PruneOptions& options = {});
  ~Pruner();
  Pruner(Pruner&&) noexcept;

  /// The regions at the present state of both sets.
  /// @param gap   distance between skins that still counts [m], not negative
  /// @param time  to the next query [s], not negative: see ContactRegion::gap
  std::span<const ContactRegion> query(double gap, double time = 0.0);
  /// Skin of both bodies that may have met on its way to where it is: with the sets' motions set to ways,
  /// every face of a that any point of b passed is in `faces_a`, and the other way round.  Empty where no
  /// pair of proxies moved by more than a quarter of the thinner one's thickness at rest: nothing has gone
  /// through.
  void met_on_the_way(std::vector<int>& faces_a, std::vector<int>& faces_b);
  const PruneCounts& counts() const;
  /// Normals and counts of the queries so far.
  void archive(Archive& a);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::proxy
