#include "row.h"

namespace palpate::stability {

std::vector<Row> all_rows() {
  return {youngs_modulus_row(), undamped_row(),       poissons_ratio_row(),    step_row(),
          sliver_row(),         squashed_row(),       density_ratio_row(),     contact_stiffness_row(),
          impact_row(),         swallowed_tool_row(), thrown_handle_row(),     rest_row(),
          size_row(),           million_ticks_row(),  million_tool_ticks_row()};
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
