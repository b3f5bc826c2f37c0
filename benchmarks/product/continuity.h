#pragma once
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::bench {

/// Sampled rigid motions of a scene's last body relative to its contact partner (relative_path.h).
struct ContinuityOptions {
  int paths = 100;
  int steps = 100;   ///< Steps per path.
  int halvings = 7;  ///< Bisections of a step across which the force changes by more than `threshold`.
  double threshold = 0.02;
  std::uint32_t seed = 1;
  std::string method = "distance";  ///< Method of all contacts except with obstacles; or "image".
  double quadrature_error = 1e-3;   ///< For nearest points.
};

/// Remaining change of a step after its bisections. A smooth force has then changed by 2^-halvings of the
/// step's change; a jump remains.
struct ForceJump {
  int path = 0;
  double at = 0.0;  ///< Position along the path, 0 to 1.
  /// Change of the force over its size, or over a tenth of the path's largest if that is more.
  double force = 0.0;
  double moment = 0.0;      ///< Change of the moment about the first point of touch, over force times arm.
  double size_n = 0.0;      ///< Reference of `force` [N].
  bool by_history = false;  ///< Depends on the preceding path: the same pose has two forces.
};

struct ContinuityRow {
  int paths = 0;
  long steps = 0;                ///< Steps with contact.
  long queries = 0;              ///< Including refinement.
  double force = 0.0;            ///< Largest [N].
  std::vector<ForceJump> jumps;  ///< Over all bisected steps, in the paths' order.
  /// Largest force jump of each path with contact; 0: no step was bisected.
  std::vector<double> worst_of_path;
};

/// Measures the force on the scene's last body as a function of its pose. The body is moved rigidly: nothing
/// deforms or has a velocity, and each pose has one query that uses the previous ones, as in a run.
/// @param description scene with the contacts to be measured
/// @param options paths, steps and method
/// @param stop true: ends early, with the results so far
/// @throws Error if the scene's last body has contacts only with obstacles
ContinuityRow bench_continuity(scene::Description description, const ContinuityOptions& options,
                               const std::atomic<bool>* stop = nullptr);

}  // namespace palpate::bench
