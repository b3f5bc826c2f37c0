#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/array_job.h"
#include "cli/scene_of.h"

namespace CLI {
class App;
}

namespace palpate::cli {

/// Arguments of `palpate stability`.
struct StabilityArguments {
  std::vector<std::string> rows, integrators;  ///< Rows and integrators to run; empty: all
  bool slow = false;                           ///< Includes the rows that take minutes
  bool cells = false;                          ///< Prints every cell, not only the unexpected ones
  int seeds = 10, jobs = 1;
  double limit_s = 20.0;  ///< Limit of the CPU time per cell [s]
  std::string folder;     ///< Output folder; empty: out/stability, or out/stability-haptic-NAME with --haptic
  bool fresh = false;     ///< Discards the results of earlier calls in the folder
  ArrayArguments array;

  // haptic loop of a scene (--haptic)
  bool haptic = false;
  SceneArguments scene;
  std::optional<double> device_mass_kg, device_damping_n_s_m;  ///< Empty: the values of the scene
  std::optional<int> delay_ticks;
  std::vector<double> contact_stiffness_n_m;  ///< Least and greatest; empty: estimated from the scene
};

/// Adds `palpate stability`, with the options of the matrix and of --haptic.
/// @param then  action called after parsing
void add_stability(CLI::App& app, std::function<void(const std::shared_ptr<StabilityArguments>&)> then);

}  // namespace palpate::cli
