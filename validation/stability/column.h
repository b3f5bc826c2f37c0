#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::stability {

/// One way of integrating: a registry entry, under error control or at a fixed step.  A method that can do
/// both makes two columns, for its stability function shows only at a step that it does not choose.
struct Column {
  std::string label;                              ///< "ark-dirk-...", or that and ", fixed step"
  std::string name;                               ///< in the registry
  const dynamics::StepperEntry* entry = nullptr;  ///< null: an integrator of the tool's own ticks
  bool fixed = false;
};
std::vector<Column> stepper_columns(const dynamics::StepperRegistry& registry);
std::vector<Column> tool_columns();  ///< empty where tools were not compiled in

inline bool is_static(const Column& column) {
  return column.entry->traits.stability == dynamics::Stability::kStatic;
}
inline bool is_explicit(const Column& column) {
  return column.entry->traits.stability == dynamics::Stability::kExplicit;
}

/// Whether it takes a contact apart from the bodies: explicitly, or in fast steps.
inline bool splits(const Column& column) {
  return column.entry->traits.family == "ImEx Runge-Kutta" || column.entry->traits.family == "multi-rate";
}

/// Internal steps between two outputs that a cell allows: deterministic, so that verdicts do not depend on
/// the machine's speed.
inline constexpr int kMaxSteps = 20000;

/// Settings of a column: rtol where it controls its error, step_s where it does not.
IntegratorSpec spec_of(const Column& column, double rtol, double step_s);
/// @throws Error where the method refuses the system or the settings
std::unique_ptr<dynamics::Stepper> make_stepper(const Column& column, dynamics::System& system,
                                                dynamics::State& state, const IntegratorSpec& spec);

}  // namespace palpate::stability
