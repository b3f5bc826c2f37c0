#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/scene_of.h"

namespace CLI {
class App;
}

namespace palpate::cli {

struct StabilityArguments {
  std::vector<std::string> rows, integrators;  ///< empty: all
  bool slow = false;                           ///< the rows that take minutes, too
  bool cells = false;                          ///< print every cell, not only the unexpected ones
  int seeds = 10, jobs = 1;
  double limit_s = 20.0;  ///< CPU time of a cell
  std::string folder;     ///< empty: out/stability; haptic: out/stability-haptic-NAME

  // of the haptic loop of a scene
  bool haptic = false;
  SceneArguments scene;
  std::optional<double> device_mass_kg, device_damping_n_s_m;  ///< the scene's where not given
  std::optional<int> delay_ticks;
  std::vector<double> contact_stiffness_n_m;  ///< least and greatest; empty: estimated from the scene
};

/// Adds `palpate stability`, with the options of the matrix and of --haptic.
/// @param then  called after parsing
void add_stability(CLI::App& app, std::function<void(const std::shared_ptr<StabilityArguments>&)> then);

}  // namespace palpate::cli
