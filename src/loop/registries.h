#pragma once
#include <string>
#include <vector>

#include "palpate/dynamics/stepper.h"

namespace palpate::loop {

/// One valid name in a scene or an option.
struct Choice {
  std::string name, summary;
  int order = 0;  ///< Theoretical order of accuracy; 0: not applicable.
};

/// Choices of one registry, under its name in `palpate list`: "integrators", "linear-solvers", "materials",
/// "tool-integrators", "obstacles", "contact-methods", "contact-springs", "contact-laws", "generators",
/// "devices", "device-profiles", "motions", "parts".
struct ChoiceList {
  std::string what, summary;
  std::vector<Choice> choices;
};
/// Returns all registries of all parts of this build.
std::vector<ChoiceList> registries();

/// Returns the integrators of soft bodies with their theoretical properties, for comparisons and stability
/// studies.
const dynamics::StepperRegistry& steppers();
/// Returns the integrators of the tool's ticks; empty in a build without tools.
std::vector<Choice> tool_steppers();

}  // namespace palpate::loop
