#pragma once
#include <limits>
#include <string>

#include "palpate/store/run_file.h"

namespace palpate::report {

/// How much of a run a page may hold.
struct ViewBudget {
  int vertices = 6000;              ///< of all parts together
  long position_bytes = 3'000'000;  ///< as numbers; a third more as text
  int steps = 240;
};

/// Surfaces of a run over time as JSON, from which the page's script draws them
/// (src/report/page/src/view.js): `times_s`; the box `low_m`, `high_m`, within which a coordinate is a 16-bit
/// number; `first_shown`, the step to begin with; `most_displacement_m`; and `parts`
/// with name, kind (body or tool), the number of vertices, and little-endian 16-bit numbers in base64: faces,
/// rest, positions step by step. Empty where the run has no step, or a step whose positions are not finite
/// and nothing before it.
/// @param shown_at_s  the first step from then on is shown first; NaN: when the displacement is largest
std::string surface_json(const store::RunReader& run, const ViewBudget& budget = {},
                         double shown_at_s = std::numeric_limits<double>::quiet_NaN());

}  // namespace palpate::report
