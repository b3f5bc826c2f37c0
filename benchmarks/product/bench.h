#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::bench {

/// Median wall times [ms] of one step of an integrator and of its stages, on the cantilever box of the
/// soft-body benchmarks (1.0 x 0.25 x 0.25 m, E = 1e6 Pa, nu = 0.4, one end held, under its weight).
struct FemBench {
  std::string integrator;
  double step_s = 0.0;
  int nodes = 0, tetrahedra = 0, steps = 0;
  double force_ms = 0.0, tangent_ms = 0.0, factor_ms = 0.0, solve_ms = 0.0;
  double other_ms = 0.0;  ///< Rest of the step.
  double step_ms = 0.0;
  double assemble_s = 0.0;  ///< From scene to first step.
  double peak_mib = 0.0;    ///< Peak memory of the process.
};
/// @param cells_along cells along the metre; a quarter of this number across (36: 3,700 nodes, 14,580
/// tetrahedra)
/// @param step_s length of a step [s]
/// @param steps number of timed steps
/// @param linear_solver name of the linear solver
FemBench bench_fem(int cells_along, double step_s, int steps, const std::string& linear_solver);

/// One way of running a scene, measured in a separate process (medians over interleaved repeats).
struct LeaveOutRow {
  std::string variant;
  double startup_ms = 0.0;  ///< From description to first step.
  double memory_mib = 0.0;  ///< Resident at the end.
  double step_ms = 0.0;     ///< Wall time per period.
  /// Step time over that of the bare loop, median of the ratios of neighbouring runs.
  double ratio = 1.0;
};

/// Measures the overhead of absent parts and the cost of additional ones: the bare loop over the scene's
/// parts, palpate's loop, and this loop with recording, with a plane, with a tool, and with a tool whose
/// contact is found in image space, each out of reach, where built in.
std::vector<LeaveOutRow> bench_leave_out(const scene::Description& description, int repeats);

}  // namespace palpate::bench
