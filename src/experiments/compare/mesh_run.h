#pragma once
#include <atomic>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/loop/run.h"
#include "palpate/scene/description.h"

namespace palpate::compare {

/// Result of a scene at one resolution.
struct MeshRun {
  std::vector<double> times;  ///< [s]
  /// With a tool: force on the first hand at each tick [N].  Without one: the largest displacement of a node
  /// after each period, as a vector [m].
  Points series;
  long elements = 0, nodes = 0, surface_vertices = 0;  ///< Sums over all bodies.
  long most_samples = 0;                               ///< Largest number of contact samples at one time.
  double setup_s = 0.0;                                ///< CPU time of assembly [s].
  loop::RunResult result;

  void archive(Archive& a);
};

/// Assembles and runs a scene.  @throws Error for a scene that cannot be assembled
MeshRun run_for_mesh(const scene::Description& description, double duration_s, const std::atomic<bool>* stop);

}  // namespace palpate::compare
