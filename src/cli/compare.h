#pragma once
#include <string>
#include <vector>

namespace palpate::cli {

class MissingOutputs;

/// Arguments of `palpate compare`.
struct CompareArguments {
  std::vector<std::string> scenes;
  std::vector<std::string> overrides;  ///< of every scene
  std::string folder;
  std::vector<std::string> integrators;  ///< names, or labels of ladders; empty: every one
  bool all = false;                      ///< all others beside those named
  int repeats = 3, jobs = 0;             ///< jobs = 0: what is timed runs alone
  double limit_s = 10.0, reference_limit_s = 120.0;
  double duration_s = 0.0;
  std::string linear_solver = "cholmod";  ///< of all; "best": each method's fastest; "named": the scene's
  bool fresh = false;                     ///< forget what an earlier study left in the folder
  bool haptic = false;                    ///< what a hand feels against one system, of one scene
};

/// Compares the error and run time of integrators.  @return the exit status
int compare(const CompareArguments& arguments);

/// Compares as a part of another command, which reports and closes `missing`.
int compare(const CompareArguments& arguments, MissingOutputs& missing);

/// Compares the force and torque on the hand with the monolithic solution (--haptic).
/// @return the exit status
int compare_haptic(const CompareArguments& arguments);

}  // namespace palpate::cli
