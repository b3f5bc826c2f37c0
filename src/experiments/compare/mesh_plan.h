#pragma once
#include "experiments/compare/mesh_comparison.h"
#include "experiments/compare/refined_meshes.h"

namespace palpate::compare {

/// Time integration of all levels: it must be accurate, and equal for all, but need not be the scene's.
struct MeshSteps {
  std::vector<std::string> overrides;
  double step_s = 0.0;  ///< 0: error control, or equilibrium.
  std::string made_by;
};

/// Returns the time integration of a comparison of meshes.  With a tool: the single-rate scheme with steps of
/// order 2.  Without: the scene's integrator.
/// @param divisions  number of times that steps, or tolerances, are refined; -1: the coarser check
MeshSteps mesh_steps(const scene::Description& description, int divisions);

/// Returns why a scene's resolution cannot be refined, or why all together add nothing; empty where it can.
std::string why_unchanged(const scene::Description& description, const std::string& variable);

/// Returns the overrides that refine one resolution of a scene.
/// @param meshes  makes the files of refined meshes
/// @param divisions  number of divisions by two; negative: coarser, for generated meshes only
/// @throws Error where a file cannot be refined
std::vector<std::string> mesh_overrides(const scene::Description& description, const std::string& variable,
                                        int divisions, RefinedMeshes& meshes);

/// Returns the end of the longest rest of the scripted handle after its first motion [s]; NaN where the
/// device has no script, or where the script has no rest before `duration_s`.
double end_of_hold(const scene::Description& description, double duration_s);

}  // namespace palpate::compare
