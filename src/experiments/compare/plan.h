#pragma once
#include <map>

#include "palpate/experiments/comparison.h"

namespace palpate::compare {

/// Parses the scene's text again, with overrides as for `--set`.
scene::Description with_overrides(const scene::Description& description,
                                  const std::vector<std::string>& overrides);

/// Returns the overrides that run a sequence's integrator at `value`, with the sequence's other settings.
std::vector<std::string> overrides_of(const scene::LadderSpec& ladder, double value);

/// Returns the registry's entry of an integrator; null where there is none.
const dynamics::StepperEntry* find_stepper(const std::string& name);

/// Formats a number that reads back exactly, as a TOML float.
std::string toml_number(double value);

/// Linear solvers of a scene's sequences: by label, or else `of_all`; empty: unchanged.
struct SolverChoice {
  std::string of_all;
  std::map<std::string, std::string> by_label = {};
};

/// Plans the points of one scene: its sequences, and a default one for every other requested integrator,
/// coarsest level first.
/// @throws Error for unknown names, and for a setting that does not apply to an integrator
std::vector<ComparePoint> plan_points(const scene::Description& description, const CompareOptions& options,
                                      const SolverChoice& choice);
/// Plans the middle level of each implicit sequence with each linear solver, labelled trial_label().
std::vector<ComparePoint> plan_trials(const scene::Description& description, const CompareOptions& options);
/// Returns the label of a trial: "LABEL by SOLVER".
std::string trial_label(const std::string& label, const std::string& solver);

/// Plans runs that measure the cost of re-initialisation: each sequence of the scene at the scene's tolerance
/// or step, with each refresh period.
std::vector<ComparePoint> plan_restarts(const scene::Description& description, const CompareOptions& options,
                                        const SolverChoice& choice);

/// Reference and its check, by another integrator and another factorisation.  For a scene without bodies, the
/// tool is simulated by Simbody's two error-controlled integrators, at half of the finest tick of any level.
struct PlannedReference {
  std::string made_by, checked_by;  ///< Descriptions, with tolerance.
  scene::Description primary, check;
  std::string made_with, checked_with;  ///< Integrators.
};
/// Plans the reference of a scene and its check.  @throws Error for integrators without error control
PlannedReference plan_reference(const scene::Description& description,
                                const std::vector<ComparePoint>& points);

}  // namespace palpate::compare
