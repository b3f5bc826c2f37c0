#pragma once
#include <string>
#include <vector>

#include "palpate/dynamics/stepper.h"

namespace palpate::loop {

/// One name that a scene or an option knows.
struct Choice {
  std::string name, summary;
  int order = 0;  ///< theoretical order of accuracy where there is one, else 0
};

/// Every registry of every part that was compiled in, under the name that `palpate list` knows it by:
/// "integrators", "linear-solvers", "materials", "tool-integrators", "obstacles", "contact-methods",
/// "generators", "devices", "parts".
struct ChoiceList {
  std::string what, summary;
  std::vector<Choice> choices;
};
std::vector<ChoiceList> registries();

/// The integrators of soft bodies with their theoretical properties: comparisons and stability studies run
/// over them.
const dynamics::StepperRegistry& steppers();
/// The integrators of the tool's own ticks; empty where tools were not compiled in.
std::vector<Choice> tool_steppers();

}  // namespace palpate::loop
