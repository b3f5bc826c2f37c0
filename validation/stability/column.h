#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::stability {

/// One way of integrating: a registry entry, under error control or at a fixed step. A method that supports
/// both has two columns, because its stability function is observable only at a prescribed step.
struct Column {
  std::string label;                              ///< "ark-dirk-...", or with the suffix ", fixed step".
  std::string name;                               ///< Name in the registry.
  const dynamics::StepperEntry* entry = nullptr;  ///< Null: an integrator of the tool's ticks.
  bool fixed = false;
};
std::vector<Column> stepper_columns(const dynamics::StepperRegistry& registry);
std::vector<Column> tool_columns();  ///< Empty if tools were not compiled in.

inline bool is_static(const Column& column) {
  return column.entry->traits.stability == dynamics::Stability::kStatic;
}
inline bool is_explicit(const Column& column) {
  return column.entry->traits.stability == dynamics::Stability::kExplicit;
}

/// Returns whether the method treats a contact separately from the bodies: explicitly, or in fast steps.
inline bool splits(const Column& column) {
  return column.entry->traits.family == "ImEx Runge-Kutta" || column.entry->traits.family == "multi-rate";
}

/// Internal steps that a cell allows between two outputs: deterministic, so that verdicts do not depend on
/// the speed of the machine.
inline constexpr int kMaxSteps = 20000;

/// Returns the settings of a column: rtol under error control, step_s otherwise.
IntegratorSpec spec_of(const Column& column, double rtol, double step_s);
/// @throws Error if the method rejects the system or the settings
std::unique_ptr<dynamics::Stepper> make_stepper(const Column& column, dynamics::System& system,
                                                dynamics::State& state, const IntegratorSpec& spec);

}  // namespace palpate::stability
