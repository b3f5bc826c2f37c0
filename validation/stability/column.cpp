#include "column.h"

#include <algorithm>

#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "palpate/tool/tool.h"

namespace palpate::stability {

using dynamics::StepControl;

std::vector<Column> stepper_columns(const dynamics::StepperRegistry& registry) {
  std::vector<Column> columns;
  for (const auto& entry : registry) {
    const StepControl control = entry.traits.control;
    columns.push_back({entry.name, entry.name, &entry, control == StepControl::kFixed});
    if (control == StepControl::kEither)
      columns.push_back({entry.name + ", fixed step", entry.name, &entry, true});
  }
  // Adjacent columns show the effect of error control.
  std::stable_partition(columns.begin(), columns.end(), [](const Column& column) { return !column.fixed; });
  return columns;
}

std::vector<Column> tool_columns() {
  std::vector<Column> columns;
  for (const auto& info : tool::tool_integrators())
    columns.push_back({"tool: " + info.name, info.name, nullptr, false});
  return columns;
}

IntegratorSpec spec_of(const Column& column, double rtol, double step_s) {
  IntegratorSpec spec;
  spec.name = column.name;
  spec.rtol = rtol;
  spec.step_s = step_s;
  spec.fixed_step = column.fixed && column.entry->traits.control == StepControl::kEither;
  spec.max_steps = kMaxSteps;
  return spec;
}

std::unique_ptr<dynamics::Stepper> make_stepper(const Column& column, dynamics::System& system,
                                                dynamics::State& state, const IntegratorSpec& spec) {
  const dynamics::StepperTraits& traits = column.entry->traits;  // The entry may be in no registry.
  auto solver = traits.implicit
                    ? linear::make_linear_solver(
                          spec.linear_solver.empty() ? traits.linear_solver : spec.linear_solver, spec)
                    : nullptr;
  return column.entry->make(system, state, spec, std::move(solver));
}

}  // namespace palpate::stability
