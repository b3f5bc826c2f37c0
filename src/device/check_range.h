#pragma once
#include "palpate/core/error.h"
#include "palpate/core/keys.h"

namespace palpate::device {

/// Checks one parameter.  @throws Error `device: KEY = VALUE ...` for a value out of range
inline void check_range(const char* key, double value, const Range& range) {
  if (!range.holds(value)) fail("device: {} = {} {}", key, value, range.demand());
}

}  // namespace palpate::device
