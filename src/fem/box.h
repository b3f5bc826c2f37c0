#pragma once
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/types.h"

namespace palpate::fem {

inline bool in_box(const Vec3& p, const Vec3& low, const Vec3& high) {
  return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
}

inline std::string describe(const Vec3& low, const Vec3& high) {
  return fmt::format("({}, {}, {}) to ({}, {}, {}) m", low.x(), low.y(), low.z(), high.x(), high.y(),
                     high.z());
}

inline void check_box(const Vec3& low, const Vec3& high, const char* what) {
  for (int i = 0; i < 3; ++i)
    if (!(low[i] <= high[i]))
      fail("{}: box_min_m[{}] = {} must not exceed box_max_m[{}] = {}", what, i, low[i], i, high[i]);
}

}  // namespace palpate::fem
