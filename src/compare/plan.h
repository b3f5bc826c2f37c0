#pragma once
#include <map>

#include "palpate/compare/compare.h"

namespace palpate::compare {

/// The scene parsed anew from its text, changed as `--set` does.
scene::Description with_overrides(const scene::Description& description,
                                  const std::vector<std::string>& overrides);

/// Arguments of `--set` that make a ladder's integrator step by `value`, with what else the ladder sets.
std::vector<std::string> overrides_of(const scene::LadderSpec& ladder, double value);

/// The registry's entry of an integrator; null where there is none.
const dynamics::StepperEntry* find_stepper(const std::string& name);

/// A number so that it reads back exactly, and as a TOML float.
std::string toml_number(double value);

/// Linear solvers of a scene's ladders: by label, else of all; empty: their own.
struct SolverChoice {
  std::string of_all;
  std::map<std::string, std::string> by_label = {};
};

/// The points of one scene: its own ladders and a default one for every other integrator that is wanted,
/// coarsest rung first.
/// @throws Error for names that nobody knows, and for a setting that an integrator does not step by
std::vector<ComparePoint> plan_points(const scene::Description& description, const CompareOptions& options,
                                      const SolverChoice& choice);
/// The middle rung of each implicit ladder, by each linear solver, labelled trial_label().
std::vector<ComparePoint> plan_trials(const scene::Description& description, const CompareOptions& options);
std::string trial_label(const std::string& label, const std::string& solver);

/// The runs that show the cost of re-initialisation: each ladder of the scene at the scene's own tolerance or
/// step, at each refresh period.
std::vector<ComparePoint> plan_restarts(const scene::Description& description, const CompareOptions& options,
                                        const SolverChoice& choice);

/// The reference and its check, by another integrator and another factorisation.  A scene without bodies
/// takes the tool by Simbody's two error-controlled integrators, at a tick finer than any rung.
struct PlannedReference {
  std::string made_by, checked_by;  ///< with tolerance, in words
  scene::Description primary, check;
  std::string made_with, checked_with;  ///< integrators
};
PlannedReference plan_reference(const scene::Description& description,
                                const std::vector<ComparePoint>& points);

}  // namespace palpate::compare
