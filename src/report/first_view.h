#pragma once
#include <optional>

#include "palpate/core/types.h"

namespace palpate::report {

/// First view of the bodies on a page, in place of that of their run.
struct FirstView {
  std::optional<Vec3> from = {};    ///< Direction to the eye, not zero
  std::optional<double> zoom = {};  ///< Magnification
};

}  // namespace palpate::report
