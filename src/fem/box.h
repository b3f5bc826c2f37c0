#pragma once
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/types.h"

namespace palpate::fem {

/// Returns the tolerance [m] by which a box or sphere is enlarged, so that nodes on its border are inside: a
/// millionth of the mesh's extent, which covers files in single precision or with six digits, plus the
/// rounding of a placement.
inline double selection_tolerance(const Points& placed) {
  if (placed.cols() == 0) return 0.0;
  constexpr double kOfExtent = 1e-6, kRounding = 1e-15;
  return kOfExtent * (placed.rowwise().maxCoeff() - placed.rowwise().minCoeff()).norm() +
         kRounding * placed.cwiseAbs().maxCoeff();
}

inline bool in_box(const Vec3& p, const Vec3& low, const Vec3& high, double tolerance) {
  return (p.array() >= low.array() - tolerance).all() && (p.array() <= high.array() + tolerance).all();
}

inline std::string describe(const Vec3& low, const Vec3& high) {
  return fmt::format("({}, {}, {}) to ({}, {}, {}) m", low.x(), low.y(), low.z(), high.x(), high.y(),
                     high.z());
}

/// @throws Error if a lower bound exceeds its upper bound; `what` begins the message
inline void check_box(const Vec3& low, const Vec3& high, const char* what) {
  for (int i = 0; i < 3; ++i)
    if (!(low[i] <= high[i]))
      fail("{}: box_min_m[{}] = {} must not exceed box_max_m[{}] = {}", what, i, low[i], i, high[i]);
}

}  // namespace palpate::fem
