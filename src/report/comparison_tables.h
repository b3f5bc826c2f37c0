#pragma once
#include <string>
#include <vector>

#include "comparison_cells.h"
#include "report/page.h"
#include "report/table.h"

/// The tables of a comparison, each of one scene.
namespace palpate::report {

/// The error column that decides: positions, or else forces.
inline constexpr const char* kPosition = "position_error_rel_l2";

void add_points_table(Page& page, const Table& compare);
void add_counts_and_maxima(Page& page, const Table& compare);
void add_orders_table(Page& page, const Table& compare, const std::vector<Quantity>& quantities);
/// The winner at each target error, by a cost.
/// @param scale  what the targets are shares of  @param explained  with a caption that says how it is found
void add_winners_table(Page& page, const Table& compare, const Quantity& q, double scale,
                       const std::string& cost_column, const std::string& cost_label, bool explained);
/// The cost of each integrator at each target error, with its fitted order.
void add_costs_table(Page& page, const Table& compare, double reference_error);

}  // namespace palpate::report
