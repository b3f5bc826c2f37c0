#pragma once
#include <string>
#include <vector>

#include "cli/array_job.h"
#include "palpate/scene/description.h"

namespace palpate::cli {

/// Arguments of `palpate compare`.
struct CompareArguments {
  std::vector<std::string> scenes;
  std::vector<std::string> overrides;    ///< Changes of keys of every scene
  std::string folder;                    ///< Output folder; empty: out/compare-SCENE
  std::vector<std::string> integrators;  ///< Names, or labels of [[compare.ladder]]; empty: all
  bool all = false;                      ///< Includes all integrators in addition to `integrators`
  int repeats = 3, jobs = 0;             ///< jobs = 0: timed runs run alone
  double limit_s = 10.0, reference_limit_s = 120.0;  ///< Limits of the CPU time of one run [s]
  double duration_s = 0.0;                           ///< Simulated time [s]; 0: the duration of each scene
  std::string linear_solver = "cholmod";             ///< Or "best" (of each method), "named" (by the scene)
  bool fresh = false;   ///< Discards the results of an earlier study in the folder
  bool haptic = false;  ///< Compares one scene with its monolithic solution
  bool mesh = false;    ///< Refines elements, skin and contact points of one scene
  bool json = false;    ///< Mesh: prints summary.json instead of tables
  int levels = 3;       ///< Mesh: number of levels
  int coarser = 0;      ///< Mesh: number of levels that are coarser than the scene
  ArrayArguments array;
};

/// Returns the use of a folder by a comparison.
TaskFolder::Use use_of(const CompareArguments& arguments, const std::string& folder);

/// Returns the scene of a comparison that takes one, with the changes of the command line.
/// @param option  option that selects the comparison, for messages
/// @throws Error for another number of scenes
scene::Description one_scene_of(const CompareArguments& arguments, const char* option);

/// Compares the error and run time of integrators.  @return the exit status
int compare(const CompareArguments& arguments);

/// Compares as a part of another command, which reports and closes `missing`.
int compare(const CompareArguments& arguments, MissingOutputs& missing);

/// Compares the force and torque on the hand with the monolithic solution (--haptic).
/// @return the exit status
int compare_haptic(const CompareArguments& arguments);

/// Estimates the error of the force on the hand due to the mesh (--mesh).  @return the exit status
int compare_mesh(const CompareArguments& arguments);

/// Prints the error of a scene's force due to elements, skin and contact points together, in one line per
/// figure, from one finer level.
/// @param scene  name or file  @param folder  folder for refined meshes
void print_mesh_error(const std::string& scene, const std::string& folder);

}  // namespace palpate::cli
