#pragma once
#include "experiments/compare/mesh_comparison.h"
#include "experiments/compare/refined_meshes.h"
#include "experiments/engine.h"
#include "store/summary.h"

namespace palpate::compare {

/// Options of compare_mesh().
struct MeshOptions {
  int levels = 3;          ///< Number of levels; each divides the resolution by two.
  int coarser = 0;         ///< Number of levels that are coarser than the scene; less than `levels`.
  double limit_s = 900.0;  ///< CPU seconds per run.
  int jobs = 0;            ///< Number of parallel runs; 0: one at a time, since they are timed.
  std::vector<std::string> variables = {kElements, kSkin, kPoints, kTogether};  ///< Resolutions to refine.
  /// Largest number of times that steps are halved until the time error is below a tenth of the differences.
  int halvings = 2;
  std::string folder;         ///< Folder for refined meshes, in a subfolder "meshes".
  MakeModel make_model = {};  ///< Makes shapes of the model program at other resolutions.
  std::function<void(double fraction, const std::string& what)> progress = {};
  const std::atomic<bool>* stop = nullptr;  ///< Set from outside: active runs are ended.
};

/// Refines elements, skin and contact points of a scene, one at a time and together, and estimates the error
/// of the force on the hand due to each (grid_convergence.h).  Every level runs with the same accurate time
/// integration, and again with steps twice as long: their difference is the time error of the level.
/// @param place  where the runs are made and kept
/// @param outcome  what was run
/// @throws Error for a scene without bodies
MeshComparison compare_mesh(const scene::Description& description, const MeshOptions& options,
                            const experiments::Place& place, experiments::EngineOutcome& outcome);

/// Estimates the error due to elements, skin and contact points together from the scene's resolution and one
/// finer level: the cheap form of compare_mesh(), whose order is assumed.
/// @param folder, make_model  as in MeshOptions
/// @param place  where the runs are made and kept
/// @throws Error for a scene without bodies
MeshComparison mesh_error(const scene::Description& description, const std::string& folder,
                          const MakeModel& make_model, const experiments::Place& place);

/// Returns the error of the scene's resolution in sentences: first all resolutions together, then each.
std::vector<std::string> in_words(const MeshComparison& comparison);

/// Writes mesh.csv into `folder`: report takes its table and charts from it and from summary.json.
void write(const MeshComparison& comparison, const std::string& folder);

/// Adds levels and errors, and the sentences as remarks.
void add_to_summary(store::Summary& summary, const MeshComparison& comparison);

}  // namespace palpate::compare
