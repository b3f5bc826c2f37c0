#pragma once
#include <string>
#include <vector>

#include "experiments/compare/grid_convergence.h"
#include "palpate/experiments/comparison.h"

namespace palpate::compare {

// Resolutions of a scene, as named in tables and charts.
inline constexpr const char* kElements = "element size";
inline constexpr const char* kSkin = "skin";
inline constexpr const char* kPoints = "contact points";
inline constexpr const char* kTogether = "together";

/// One figure of a level.
struct MeshValue {
  double value = std::numeric_limits<double>::quiet_NaN();       ///< [N], or [m] without a tool.
  double time_error = std::numeric_limits<double>::quiet_NaN();  ///< Change from steps twice as long.
};

/// The scene at one resolution.
struct MeshLevel {
  int divisions = 0;  ///< Number of divisions of the scene's resolution by two; 0: the scene's.
  double size = 1.0;  ///< Size of elements, triangles or point spacing, relative to the scene's.
  Status status = Status::kMissing;
  std::string reason;  ///< Reason, where the status is not kOk.
  long elements = 0, nodes = 0, surface_vertices = 0, most_samples = 0;
  double cpu_s = 0.0, setup_s = 0.0;  ///< CPU time of the loop and of assembly [s].
  std::vector<MeshValue> values;      ///< One per figure.
  /// RMS difference of the series from that of the finest level; NaN for that level.
  double from_finest = std::numeric_limits<double>::quiet_NaN();
};

/// Error of one figure due to one resolution.
struct MeshError {
  GridEstimate limit;                                       ///< Value for elements of size zero.
  double error = std::numeric_limits<double>::quiet_NaN();  ///< Value at the scene's resolution minus limit.
  /// Largest time error of a level over the smallest difference of neighbouring levels.
  double time_share = std::numeric_limits<double>::quiet_NaN();

  /// Whether the time error of each level is below a tenth of the differences between levels.
  bool is_resolved() const { return time_share <= 1.0 / kResolution; }
};

/// Levels of one resolution.
struct MeshVariable {
  std::string name;
  std::string unchanged;  ///< Reason why the scene has no such resolution; empty: it has.
  double step_s = 0.0;    ///< Steps of the levels [s]; the check uses twice as much. 0: error control.
  std::vector<MeshLevel> levels;  ///< From coarse to fine.
  std::vector<MeshError> errors;  ///< One per figure; empty with fewer than two levels that ran.
};

/// Result of `palpate compare --mesh`.
struct MeshComparison {
  std::string scene, path;
  bool tool = true;                  ///< Figures are forces on the hand; else displacements.
  std::vector<std::string> figures;  ///< "peak", "hold", "RMS"
  double hold_s = 0.0;               ///< Time of "hold" or "end" [s].
  std::string made_by;               ///< Time integration of all levels.
  std::vector<MeshVariable> variables;
  std::string rules;  ///< Text that describes limits.
  long reused = 0;    ///< Number of runs taken from an earlier comparison.
  bool stopped = false;

  const char* unit() const { return tool ? "N" : "m"; }
};

}  // namespace palpate::compare
