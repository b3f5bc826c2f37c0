#pragma once
#include <string>

#include "report/plot.h"

namespace palpate::report {

/// The numbers of a plot as JSON, from which the page's script draws it (src/report/page/src/plots.js):
/// labels and axes, `series` of name, mark, colour, x, y and what stands beside points, `levels`, floor.
/// @throws Error when there is nothing to draw
std::string plot_json(const Plot& plot);

}  // namespace palpate::report
