#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/missing_outputs.h"
#include "experiments/compare/monolithic.h"
#include "loop/checkpoints.h"
#include "loop/run_figures.h"
#include "palpate/loop/run.h"

namespace palpate::session {

/// Attempted steps of a traced run.
struct TracedSteps {
  long attempted = 0, rejected = 0;
};

/// Frames that were drawn after a run.
struct DrawnFrames {
  int count = 0;                    ///< Number of frames for the simulated time
  double between_s = 0.0;           ///< Simulated time between two frames [s]
  double shown_s = 0.0;             ///< Display time of a frame in the movie [s]
  std::string folder, movie;        ///< Folder of the numbered frames, and movie file; empty: not requested
  int in_folder = 0, in_movie = 0;  ///< Number of frames written into each
  bool stopped = false;             ///< Whether drawing was stopped before all frames were written
};

/// Result of one run, its cost and its files.
struct RunOutput {
  std::string folder;  ///< Folder of the files; empty: the run writes no file
  loop::RunResult result;
  loop::RunFigures figures;
  double assemble_s = 0.0;           ///< Wall time to assemble the scene [s]
  std::vector<std::string> remarks;  ///< Lines of run_remarks()
  std::optional<TracedSteps> trace;  ///< Only of a traced run
  loop::CheckpointCost checkpoints;
  std::optional<compare::AgainstReference> against;  ///< Set if the run was compared
  /// Set if ticks of a single-rate run in real time were skipped
  std::optional<compare::AgainstReference> against_every_tick;
  /// Largest value that pictures of the run show, the end of their range before it is rounded; empty without
  /// pictures
  std::optional<double> largest_value;
  std::optional<DrawnFrames> frames;  ///< Set if frames were requested
  MissingOutputs missing;

  /// Returns whether the whole duration was simulated.
  bool is_complete() const { return result.status.ok() && !result.stopped; }
};

}  // namespace palpate::session
