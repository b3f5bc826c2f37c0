#pragma once
#include <limits>
#include <string>

#include "palpate/store/run_reader.h"

namespace palpate::report {

/// Limits on the data of a run in a page.
struct ViewBudget {
  int vertices = 6000;              ///< Vertices of all parts together
  long position_bytes = 3'000'000;  ///< Bytes of positions as numbers; base64 text takes a third more
  int steps = 240;                  ///< Number of steps
};

/// Returns the surfaces of a run over time as JSON, from which the script of the page draws them
/// (src/report/page/src/view.js): `times_s`; the box `low_m`, `high_m`, within which a coordinate is a 16-bit
/// number; `first_shown`, the step to begin with; `most_displacement_m`; and `parts` with name, kind (body or
/// tool), the number of vertices, and little-endian 16-bit numbers in base64: faces, rest, positions step by
/// step. Empty if the run has no step, or no finite positions before the first step that is not finite.
/// @param shown_at_s  the first step from this time on is shown first [s]; NaN: the step of the largest
/// displacement
std::string surface_json(const store::RunReader& run, const ViewBudget& budget = {},
                         double shown_at_s = std::numeric_limits<double>::quiet_NaN());

}  // namespace palpate::report
