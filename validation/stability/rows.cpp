#include <algorithm>

#include "row.h"

namespace palpate::stability {

std::vector<Row> all_rows() {
  return {youngs_modulus_row(),
          undamped_row(),
          stiff_modes_row(),
          poissons_ratio_row(),
          step_row(),
          split_row(),
          elements_row(),
          sliver_row(),
          squashed_row(),
          density_ratio_row(),
          contact_stiffness_row(),
          impact_row(),
          swallowed_tool_row(),
          thrown_handle_row(),
          rest_row(),
          size_row(),
          two_bodies_row(),
          million_ticks_row(),
          million_tool_ticks_row(),
          million_touch_ticks_row()};
}

std::vector<Column> columns_of(const Row& row, const dynamics::StepperRegistry& registry) {
  if (row.columns == RowColumns::kTools) return tool_columns();
  std::vector<Column> columns = stepper_columns(registry);
  if (row.columns == RowColumns::kFixedSteppers)
    std::erase_if(columns, [](const Column& column) { return !column.fixed || is_static(column); });
  if (row.columns == RowColumns::kSplitting)
    std::erase_if(columns, [](const Column& column) { return !splits(column); });
  if (row.columns == RowColumns::kFamilies)
    std::erase_if(columns, [](const Column& column) {
      static const std::vector<std::string> kept = {"linearly-implicit-euler", "backward-euler", "bdf2",
                                                    "ark-dirk-trbdf2, fixed step", "cvode-bdf"};
      return std::find(kept.begin(), kept.end(), column.label) == kept.end();
    });
  return columns;
}

std::vector<StabilityRow> stability_rows() {
  std::vector<StabilityRow> out;
  for (const Row& row : all_rows()) {
    out.push_back({row.name, row.summary, {}, row.slow});
    for (const SubCase& one : row.cases) out.back().sub_cases.push_back(one.name);
  }
  return out;
}

}  // namespace palpate::stability
