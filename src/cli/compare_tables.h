#pragma once
#include "palpate/experiments/comparison.h"
#include "report/table.h"

/// Output of `palpate compare` for one scene.
namespace palpate::cli {

/// Returns the reason of a failed point for a table: its first line, shortened.
std::string short_reason(const std::string& reason);

/// Prints how the comparison was made, and how far its reference can be trusted.
void print_reference(const compare::SceneComparison& scene);
/// Prints which linear solvers were tried for each method, if trials were requested.
void print_trials(const compare::SceneComparison& scene);
/// Prints one line per point; neighbouring levels with the same failure share a line. If the points exceed
/// the number of lines that a screen can hold, prints only their number.
void print_points(const compare::SceneComparison& scene);
/// Prints one line per refinement sequence: fitted order, best error, the cost of each of report::kTargets;
/// then the cheapest method at each target.
/// @param table  the lines of the scene in compare.csv
void print_prices(const report::Table& table, double reference_error);
void print_restarts(const compare::SceneComparison& scene);
void print_exchange(const compare::SceneComparison& scene);
void print_methods(const compare::SceneComparison& scene);

}  // namespace palpate::cli
