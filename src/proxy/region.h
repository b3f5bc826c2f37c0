#pragma once
#include <memory>

#include "palpate/core/archive.h"
#include "palpate/core/types.h"

namespace palpate::proxy {

/// Source of a region's normal: libccd's two algorithms, the last query, the distance algorithm, the line of
/// centroids, or (Pruner) the skin's area vectors.
enum class RegionMethod { kMpr, kEpa, kLastNormal, kDistance, kCentroids, kAreas };

/// Contact region of two convex hulls A and B: the plane D of the contact's image.
struct Region {
  bool found = false;           ///< the hulls overlap, or are apart by less than the margin
  Vec3 normal = Vec3::UnitZ();  ///< unit, from B to A
  /// Point of D, halfway between A's lowest and B's highest point along the normal [m].
  Vec3 origin = Vec3::Zero();
  /// max_B n.x - min_A n.x along `normal`; negative: apart by at least that much [m].
  double depth = 0.0;
  RegionMethod method = RegionMethod::kCentroids;
};

/// Counters of the safeguards.
struct RegionCounts {
  long queries = 0, overlapping = 0, apart = 0;
  long mpr = 0, epa = 0;   ///< calls of libccd's algorithms
  long bounded = 0;        ///< calls among these ended by the bound on their support points
  long most_supports = 0;  ///< largest number of support points of one call
  long not_finite = 0;     ///< results with a NaN or zero direction
  long mismatch = 0;       ///< results whose depth differs from the depth along their direction
  long last_normal = 0, distance = 0, centroids = 0;  ///< queries that ended with that normal
};

/// Finds the region of the convex hulls of two point sets (support mapping over the points), by libccd.
///
/// libccd's results are verified (touching and flat shapes give NaN directions, depths are sometimes wrong,
/// small scales miss overlaps): the pair is scaled to unit size around its common centre, and every
/// direction, from whatever algorithm, is judged by the depth that two support calls give along it.  That
/// depth bounds the penetration depth from above, so the direction with the least depth wins; the last
/// query's normal is always among the candidates.  libccd has no result for hulls that are apart; the
/// distance algorithm of Gilbert, Johnson and Keerthi (1988) then gives the direction.
class RegionFinder {
 public:
  /// 200 iterations each of GJK and EPA, with two shapes each.
  static constexpr int kMostSupports = 800;
  /// @param most_supports  largest number of support points that one call of libccd may evaluate
  explicit RegionFinder(int most_supports = kMostSupports);
  ~RegionFinder();
  RegionFinder(RegionFinder&&) noexcept;
  /// Returns the region at the direction of least depth found, and remembers its normal.
  /// @param a, b    3 x n, at least one finite point each [m]
  /// @param margin  hulls apart by more than this are not a region [m]
  /// @throws InternalError for empty or non-finite points
  Region find(const Eigen::Ref<const Points>& a, const Eigen::Ref<const Points>& b, double margin);
  /// Returns the region along a given unit normal, which becomes the last normal of `find`.
  Region along(const Eigen::Ref<const Points>& a, const Eigen::Ref<const Points>& b, const Vec3& normal,
               double margin);
  const RegionCounts& counts() const { return counts_; }
  void forget() { has_last_ = false; }  ///< clears the last normal
  void archive(Archive& a) {
    a("has_last", has_last_);
    a("last_normal", last_normal_);
  }
  /// Replaces the last normal: one finder serves many pairs that each keep their normal.
  void remember(const Vec3& normal) {
    has_last_ = true;
    last_normal_ = normal;
  }

 private:
  RegionCounts counts_;
  int most_supports_;
  bool has_last_ = false;
  Vec3 last_normal_ = Vec3::Zero();
  struct Scaled;
  std::unique_ptr<Scaled> scaled_;  // the two hulls
};

}  // namespace palpate::proxy
