#pragma once
#include <string>

#include "report/plot.h"

namespace palpate::report {

/// Returns the numbers of a plot as JSON, from which the script of the page draws it
/// (src/report/page/src/plots.js): labels and axes, `series` with name, mark, colour, x, y and texts of
/// points, `levels`, floor.
/// @throws Error if there is nothing to draw
std::string plot_json(const Plot& plot);

}  // namespace palpate::report
