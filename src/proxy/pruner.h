#pragma once
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "palpate/core/archive.h"
#include "proxy/proxy_set.h"
#include "proxy/region.h"

namespace palpate::proxy {

/// Options of a Pruner.
struct PruneOptions {
  /// Neighbouring contacts share a plane if the directions along which their skins face each other differ by
  /// less than this.
  double merge_angle_rad = 1.05;
};

/// Contact region of two bodies: the plane of its image, and the skin that may take part.
struct ContactRegion {
  Region region;                 ///< normal from b to a, plane D
  Mat3 axes = Mat3::Identity();  ///< columns u, v, normal
  /// Extent in these axes about region.origin: (u, v) where both sides have skin, w over all skin [m].
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  /// Direction along which its skins face each other, from b to a; length 2 where both are flat, 0 where one
  /// is enclosed.
  Vec3 facing = Vec3::Zero();
  std::vector<std::pair<int, int>> pairs;  ///< proxies (a, b)
  std::vector<int> faces_a, faces_b;       ///< faces of the skins, patch by patch
  /// Largest angle between its normal and the normals of its proxies of a at the last query; 0 for new
  /// regions [rad].
  double rotation = 0.0;
  /// Largest distance along the normal between two points of its skins that come within the query's gap of
  /// each other until the next query: at least that gap, and the distance that its proxies may close [m].
  double gap = 0.0;
  double approach = 0.0;   ///< bound on the closing speed along the normal, 0 or more [m/s]
  double apart = 0.0;      ///< proven distance of its hulls along the normal, 0 or more [m]
  double thickness = 0.0;  ///< least thickness of its proxies, at rest [m]
};

/// Counts of tested and excluded pairs since the pruner was made.
struct PruneCounts {
  long queries = 0;
  long pairs = 0;            ///< pairs of proxies
  long boxes_tested = 0;     ///< pairs of branches
  long after_boxes = 0;      ///< pairs of proxies whose boxes are within reach
  long apart_by_memory = 0;  ///< pairs among these proven apart by the direction of the last query
  long apart_by_search = 0;  ///< proven apart by a new direction
  long after_hulls = 0;      ///< pairs of proxies that were not proven apart
  long patches_tested = 0, patches_kept = 0;  ///< patch balls tested against hulls, and kept
  long regions = 0;
  long regions_apart = 0;  ///< proven apart as a whole, and left out
  long regions_ahead = 0;  ///< regions that are farther apart than the query's gap, but within reach
  /// Regions by the source of their normal: the skins, the last query, libccd.
  long normals_by_areas = 0, normals_kept = 0, normals_by_hulls = 0;
  long faces_a = 0, faces_b = 0;  ///< faces passed on, over all queries and regions
  double largest_rotation = 0.0;  ///< [rad]
};

/// Finds the skin of two bodies that may be in contact, grouped into regions.  The method, and why no face is
/// lost or counted twice, is derived in pruner.cpp.
///
/// Every face of a with a point nearer than `gap` to body b, or inside it, and every face that may come to
/// touch it within `time` at the present velocities (ProxySet::set_motion), is in exactly one region.  Every
/// such face of b is in each region that holds a face of a which it may meet. Directions and normals of the
/// last query are kept, so normals depend on the past where they are not unique (deep overlap); the faces do
/// not.
class Pruner {
 public:
  /// @pre both sets outlive the pruner
  /// @throws Error for a merge angle outside 0 to pi
  Pruner(const ProxySet& a, const ProxySet& b, const PruneOptions& options = {});
  ~Pruner();
  Pruner(Pruner&&) noexcept;

  /// Returns the regions at the present state of both sets, valid until the next query.
  /// @param gap   distance between skins that counts as contact [m], not negative
  /// @param time  time to the next query [s], not negative: see ContactRegion::gap
  std::span<const ContactRegion> query(double gap, double time = 0.0);
  /// Collects the skin of both bodies that may have touched on the way to the present state, with the sets'
  /// motions set to displacements: every face of a that a point of b passed is in `faces_a`, and vice versa.
  /// Both are empty if no pair of proxies moved by more than a quarter of the thinner one's rest thickness,
  /// which excludes tunnelling.
  void met_on_the_way(std::vector<int>& faces_a, std::vector<int>& faces_b);
  const PruneCounts& counts() const;
  /// Saves or restores the normals and counts of the queries so far.
  void archive(Archive& a);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::proxy
