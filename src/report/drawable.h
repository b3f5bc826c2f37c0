#pragma once
#include <vector>

#include "report/plot.h"

namespace palpate::report {

/// The series of a plot as they are drawn, each with its colour: without points that are not finite (or not
/// positive on a logarithmic axis), without series that have none left; curves without names of points are
/// thinned to `pixels` columns.
/// @throws Error when there is nothing to draw
std::vector<Series> drawable_series(const Plot& plot, std::size_t pixels);

}  // namespace palpate::report
