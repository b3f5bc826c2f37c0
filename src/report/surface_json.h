#pragma once
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "palpate/store/run_reader.h"

namespace palpate::report {

/// Limits on the data of a run in a page.
struct ViewBudget {
  int vertices = 6000;              ///< Vertices of all parts together
  long position_bytes = 3'000'000;  ///< Bytes of positions as numbers; base64 text takes a third more
  int steps = 240;                  ///< Number of steps
};

/// View of a run at the start, and how its displacements are measured.
struct ViewSettings {
  /// The first step from this time on is shown first [s]; NaN: the step of the largest displacement
  double shown_at_s = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> free_bodies = {};  ///< Bodies whose rigid motion is no part of their displacement
  /// Names of the tools, by hand; other parts without tetrahedra are bones. Empty: all of them are tools.
  std::vector<std::string> tools = {};
  Vec3 from = Vec3(0.46, -0.80, 0.37);  ///< Direction to the eye; the default is that of pictures
  Vec3 up = Vec3::UnitZ();
  std::optional<Vec3> target_m = {};  ///< Point in the middle [m]; empty: the middle of the run
  double zoom = 1.0;
};

/// Returns the surfaces of a run over time as JSON, from which the script of the page draws them
/// (src/report/page/src/view.js): `times_s`; the box `low_m`, `high_m`, within which a coordinate is a 16-bit
/// number; `first_shown`, the step to begin with; `most_displacement_m`, the end of the range of colours,
/// rounded up; `ramp`, its colours; `from`, `up`, `target_m` (or null) and `zoom` of the first view; and
/// `parts` with name, kind (body or tool), colour, the number of vertices, and little-endian 16-bit numbers
/// in base64: faces, rest, positions step by step. A free body has `motions`, per step its rigid motion as a
/// rotation matrix by rows and a translation [m], fitted to its nodes by the volumes around them. Empty if
/// the run has no step, or no finite positions before the first step that is not finite.
std::string surface_json(const store::RunReader& run, const ViewBudget& budget = {},
                         const ViewSettings& settings = {});

}  // namespace palpate::report
