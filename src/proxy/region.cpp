#include "proxy/region.h"

#include <ccd/ccd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/counters.h"
#include "palpate/core/error.h"
#include "proxy/hull.h"

namespace palpate::proxy {
namespace {

// libccd's tolerances for shapes of unit size: the error of the depth is at most kDepthError.
//
// MPR's tolerance is a length, EPA's a squared length.  EPA's polytope has the nearest point w; a support
// point v in direction w lies e = v.w/|w| - |w| above that face, which is the error of the depth |w|.  EPA
// ends where v.w - |w|^2 = e |w| is below the tolerance, or the squared distance of v to the face, which is
// at least e^2.  With kDepthError^2 both imply e < kDepthError, for depths above kDepthError.
constexpr double kDepthError = 1e-6;
// max_iterations bounds libccd's GJK and the last loop of MPR, but neither EPA nor the refinement of MPR's
// portal.  On round shapes EPA finds a new vertex in each iteration, at a cost that grows with their number.
// Each iteration of either evaluates a support point of both shapes, so the support points are bounded: after
// `most` of them the shapes return one point, the origin.  Then v.w = 0, no face has anything above it, and
// every loop ends with the face that it has; its direction is verified like any other.
constexpr int kMaxIterations = 200;

/// Number of support points that both hulls of a pair have evaluated, and may evaluate.
struct Budget {
  int given = 0, most = 0;
  bool spent = false;
};
/// Hull in the form of a libccd object.
struct Shape {
  const Hull* hull;
  Budget* budget;
};

void ccd_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& shape = *static_cast<const Shape*>(object);
  Vec3 p = Vec3::Zero();
  if (shape.budget->given < shape.budget->most) {
    ++shape.budget->given;
    p = shape.hull->support(Vec3(ccdVec3X(direction), ccdVec3Y(direction), ccdVec3Z(direction)));
  } else {
    shape.budget->spent = true;
  }
  ccdVec3Set(out, p.x(), p.y(), p.z());
}

void ccd_centre(const void* object, ccd_vec3_t* out) {
  const Vec3& c = static_cast<const Shape*>(object)->hull->centre();
  ccdVec3Set(out, c.x(), c.y(), c.z());
}

/// libccd's result, with the normal from b to a (libccd's direction moves b away).
struct Answer {
  Vec3 normal;
  double depth;
};

using Penetration = int (*)(const void*, const void*, const ccd_t*, ccd_real_t*, ccd_vec3_t*, ccd_vec3_t*);

std::optional<Answer> ask(Penetration algorithm, const Hull& a, const Hull& b, int most_supports,
                          RegionCounts& counts) {
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = ccd_support;
  ccd.center1 = ccd.center2 = ccd_centre;
  ccd.max_iterations = kMaxIterations;
  ccd.mpr_tolerance = kDepthError;
  ccd.epa_tolerance = kDepthError * kDepthError;
  ccd_real_t depth = 0;
  ccd_vec3_t direction, position;
  Budget budget{0, most_supports};
  const Shape shape_a{&a, &budget}, shape_b{&b, &budget};
  const int status = algorithm(&shape_a, &shape_b, &ccd, &depth, &direction, &position);
  counts.most_supports = std::max<long>(counts.most_supports, budget.given);
  counts.bounded += budget.spent;
  if (status != 0) return std::nullopt;
  return Answer{-Vec3(ccdVec3X(&direction), ccdVec3Y(&direction), ccdVec3Z(&direction)), depth};
}

/// Candidate with the least depth so far.
struct Best {
  double depth = std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::Zero();
  RegionMethod method = RegionMethod::kCentroids;

  void offer(const Hull& a, const Hull& b, const Vec3& direction, RegionMethod by) {
    const double length = direction.norm();
    if (!(length > 1e-12) || !std::isfinite(length)) return;
    const Vec3 n = direction / length;
    const double along = depth_along(a, b, n).depth;
    if (along < depth) *this = {along, n, by};
  }
};

/// Runs one algorithm and offers its direction; returns true if the two support calls confirm its depth.
bool offer_answer(Penetration algorithm, RegionMethod by, const Hull& a, const Hull& b, int most_supports,
                  Best& best, RegionCounts& counts) {
  constexpr double kMismatch = 1e-3;  // [unit-sized shapes]
  const auto answer = ask(algorithm, a, b, most_supports, counts);
  if (!answer) return false;
  const double length = answer->normal.norm();
  if (!std::isfinite(length) || !std::isfinite(answer->depth) || length < 0.5) {
    ++counts.not_finite;
    return false;
  }
  best.offer(a, b, answer->normal, by);
  if (std::abs(depth_along(a, b, answer->normal / length).depth - answer->depth) <= kMismatch) return true;
  ++counts.mismatch;
  return false;
}

void check_points(const Eigen::Ref<const Points>& points, const char* which) {
  PALPATE_CHECK(points.cols() > 0, "contact region: {} has no points", which);
  PALPATE_CHECK(points.allFinite(), "contact region: a point of {} is not finite", which);
}

}  // namespace

struct RegionFinder::Scaled {
  Hull a, b;
};

RegionFinder::RegionFinder(int most_supports)
    : most_supports_(most_supports), scaled_(std::make_unique<Scaled>()) {
  counters::count("proxy.region_finder");
}
RegionFinder::~RegionFinder() = default;
RegionFinder::RegionFinder(RegionFinder&&) noexcept = default;

Region RegionFinder::along(const Eigen::Ref<const Points>& a, const Eigen::Ref<const Points>& b,
                           const Vec3& normal, double margin) {
  check_points(a, "the first body");
  check_points(b, "the second body");
  Eigen::Index lowest = 0, highest = 0;
  Region region;
  region.depth = -(normal.transpose() * a).minCoeff(&lowest) + (normal.transpose() * b).maxCoeff(&highest);
  region.origin = 0.5 * (a.col(lowest) + b.col(highest));
  region.normal = normal;
  region.method = RegionMethod::kLastNormal;
  region.found = region.depth >= -margin;
  has_last_ = true;
  last_normal_ = normal;
  return region;
}

Region RegionFinder::find(const Eigen::Ref<const Points>& a, const Eigen::Ref<const Points>& b,
                          double margin) {
  check_points(a, "the first body");
  check_points(b, "the second body");
  ++counts_.queries;
  const Vec3 low = a.rowwise().minCoeff().cwiseMin(b.rowwise().minCoeff()),
             high = a.rowwise().maxCoeff().cwiseMax(b.rowwise().maxCoeff());
  const Vec3 origin = 0.5 * (low + high);
  const double size = (high - low).maxCoeff(), scale = size > 0.0 ? 1.0 / size : 1.0;
  Hull &hull_a = scaled_->a, &hull_b = scaled_->b;
  hull_a.assign(a, origin, scale);
  hull_b.assign(b, origin, scale);

  Best best;
  ++counts_.mpr;
  if (!offer_answer(ccdMPRPenetration, RegionMethod::kMpr, hull_a, hull_b, most_supports_, best, counts_)) {
    ++counts_.epa;
    offer_answer(ccdGJKPenetration, RegionMethod::kEpa, hull_a, hull_b, most_supports_, best, counts_);
  }
  best.offer(hull_a, hull_b, hull_a.centre() - hull_b.centre(), RegionMethod::kCentroids);
  if (has_last_) best.offer(hull_a, hull_b, last_normal_, RegionMethod::kLastNormal);
  if (best.depth <= 0.0 || best.method == RegionMethod::kCentroids ||
      best.method == RegionMethod::kLastNormal)
    best.offer(hull_a, hull_b, nearest_difference(hull_a, hull_b), RegionMethod::kDistance);
  // Two coincident points: any direction is valid.
  if (best.normal.isZero()) best = {0.0, Vec3::UnitZ(), RegionMethod::kCentroids};

  counts_.last_normal += best.method == RegionMethod::kLastNormal;
  counts_.distance += best.method == RegionMethod::kDistance;
  counts_.centroids += best.method == RegionMethod::kCentroids;
  const DepthAlong along = depth_along(hull_a, hull_b, best.normal);
  Region region;
  region.normal = best.normal;
  region.method = best.method;
  region.depth = along.depth / scale;
  region.origin = origin + 0.5 / scale * (along.lowest_a + along.highest_b);
  region.found = region.depth >= -margin;
  ++(region.depth > 0.0 ? counts_.overlapping : counts_.apart);
  has_last_ = true;
  last_normal_ = region.normal;
  return region;
}

}  // namespace palpate::proxy
