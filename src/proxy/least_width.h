#pragma once
#include "palpate/core/types.h"

namespace palpate::proxy {

/// Returns the least distance of two parallel planes that enclose a point set [m].  A local search from the
/// best of 74 lattice directions; the result is never less than the true width.
/// @pre at least one point
double least_width(const Eigen::Ref<const Points>& points);

}  // namespace palpate::proxy
