#pragma once
#include <vector>

#include "report/plot.h"

namespace palpate::report {

/// Returns the series of a plot as drawn, each with its colour. Points that are not finite (or not positive
/// on a logarithmic axis) and series without remaining points are removed; curves whose points have no labels
/// are thinned to `pixels` columns.
/// @throws Error if there is nothing to draw
std::vector<Series> drawable_series(const Plot& plot, std::size_t pixels);

}  // namespace palpate::report
