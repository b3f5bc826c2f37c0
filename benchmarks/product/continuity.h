#pragma once
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::bench {

/// Rigid motions of a scene's last body against what it touches (relative_path.h), sampled.
struct ContinuityOptions {
  int paths = 100;
  int steps = 100;   ///< of a path
  int halvings = 7;  ///< of a step across which the force changes by more than `threshold`
  double threshold = 0.02;
  std::uint32_t seed = 1;
  std::string method = "distance";  ///< of all contacts but those with obstacles; or "image"
  double quadrature_error = 1e-3;   ///< of nearest points
};

/// What is left of a step after its halvings.  A smooth force has changed by 2^-halvings of the step's change
/// then; a jump stays.
struct ForceJump {
  int path = 0;
  double at = 0.0;      ///< along the path, 0 to 1
  double force = 0.0;   ///< change of the force over its size, or a tenth of the path's largest where less
  double moment = 0.0;  ///< the same of the moment about the first point of touch, over force times arm
  double size_n = 0.0;  ///< what `force` is measured by [N]
  bool by_history = false;  ///< by the path that led there: the same pose has two forces
};

struct ContinuityRow {
  int paths = 0;
  long steps = 0;                     ///< in which something presses
  long queries = 0;                   ///< refinement included
  double force = 0.0;                 ///< largest [N]
  std::vector<ForceJump> jumps;       ///< of all steps that were halved, in the paths' order
  std::vector<double> worst_of_path;  ///< largest force jump of each path with contact; 0: no step was halved
};

/// The force on the scene's last body as a function of its pose.  It is moved as a whole: nothing deforms,
/// nothing has a velocity, and each pose gets a query of its own that knows those before, as in a run.
/// @param stop  true: ends early, with what there is
/// @throws Error where the scene has no contact with its last body but with obstacles
ContinuityRow bench_continuity(scene::Description description, const ContinuityOptions& options,
                               const std::atomic<bool>* stop = nullptr);

}  // namespace palpate::bench
