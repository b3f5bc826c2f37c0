#pragma once
#include <atomic>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/archive.h"
#include "palpate/experiments/status.h"
#include "palpate/scene/description.h"

namespace palpate::study {

/// Names of columns, with their units, and values as texts that read back exactly.
using Columns = std::vector<std::pair<std::string, std::string>>;

/// Result of a task's scene.
struct SceneRun {
  experiments::Status status = experiments::Status::kOk;
  std::string reason;
  Columns figures;  ///< Bitwise reproducible by the same program.
  Columns times;    ///< Medians [s], and peak memory [MiB].

  void archive(Archive& a);  ///< Archives figures and times.
};

/// Runs a scene in this process.
/// @param repeats  number of runs; their figures must be equal
/// @throws std::bad_alloc, and InternalError for a defect of palpate
SceneRun run_scene(const scene::Description& description, int repeats, const std::atomic<bool>& out_of_time);

}  // namespace palpate::study
