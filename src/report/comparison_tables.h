#pragma once
#include <string>
#include <vector>

#include "comparison_cells.h"
#include "report/page.h"
#include "report/table.h"

/// Tables of a comparison, each for one scene.
namespace palpate::report {

/// Adds all points, one row per point.
void add_points_table(Page& page, const Table& compare);
/// Adds the counts of work and the largest errors of each point.
void add_counts_and_maxima(Page& page, const Table& compare);
/// Adds the fitted orders of each method, by quantity.
void add_orders_table(Page& page, const Table& compare, const std::vector<Quantity>& quantities);
/// Adds the cheapest method at each target error, by a cost column.
/// @param scale      size that the relative targets refer to
/// @param explained  whether the caption explains how the winner is determined
void add_winners_table(Page& page, const Table& compare, const Quantity& q, double scale,
                       const std::string& cost_column, const std::string& cost_label, bool explained);
/// Adds the cost of each integrator at each target error, with its fitted order.
void add_costs_table(Page& page, const Table& compare, double reference_error);

}  // namespace palpate::report
