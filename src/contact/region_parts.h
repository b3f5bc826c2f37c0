#pragma once
#include <span>
#include <vector>

#include "contact/region_planes.h"
#include "palpate/proxy/proxy_set.h"

namespace palpate::contact {

/// The proxies of a region that push along one normal.
struct RegionPart {
  Vec3 force = Vec3::Zero();  ///< over the stiffness [m^3]
  double volume = 0.0;        ///< of the overlap [m^3]
  std::vector<int> proxies;   ///< of a
  Vec3 normal() const { return force.normalized(); }

  Vec3 first = Vec3::Zero();  ///< normal of the first of them
};

/// Which normals the overlaps of a query are seen along, and which parts of a region share one.
class RegionParts {
 public:
  /// Normals within this angle are one: the mean has the direction of the sum of both forces, and that is
  /// shorter than the sum of both volumes by an eighth of the angle's square. [rad]
  static constexpr double kOnePlane = 0.05;

  RegionParts(const proxy::ProxySet& a, const proxy::ProxySet& b) : a_(a), b_(b) {}

  void start() { overlaps_.clear(); }
  void add(std::span<const PairOverlap> overlaps) {  ///< of one region
    overlaps_.insert(overlaps_.end(), overlaps.begin(), overlaps.end());
  }
  void find_planes();  ///< of all that was added
  /// The parts of a region that was added, the largest first; none where nothing presses.
  std::span<const RegionPart> of(std::span<const PairOverlap> overlaps);

 private:
  RegionPart& part_along(const Vec3& normal);

  const proxy::ProxySet &a_, &b_;
  std::vector<PairOverlap> overlaps_;  // by pair, once planes are found
  RegionPlanes planes_;
  std::span<const PlaneUnit> units_;
  std::vector<RegionPart> parts_;  // the first `count_` are in use
  std::size_t count_ = 0;
};

}  // namespace palpate::contact
