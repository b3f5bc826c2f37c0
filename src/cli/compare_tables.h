#pragma once
#include "palpate/compare/compare.h"
#include "report/table.h"

/// Output of `palpate compare` for one scene.
namespace palpate::cli {

constexpr std::size_t kReasonLength = 90;  ///< of why a point failed, in a table [characters]

/// How the comparison was made, and how far its reference can be trusted.
void print_reference(const compare::SceneComparison& scene);
/// Which linear solvers were tried for each method, where that was asked for.
void print_trials(const compare::SceneComparison& scene);
/// A line a point; neighbouring rungs that failed alike share a line.  Above the number that a screen can
/// hold, their number alone.
void print_points(const compare::SceneComparison& scene);
/// A line a ladder: fitted order, best error, the cost of each of report::kTargets; then the cheapest at
/// each.
/// @param table  the scene's lines of compare.csv
void print_prices(const report::Table& table, double reference_error);
void print_restarts(const compare::SceneComparison& scene);
void print_exchange(const compare::SceneComparison& scene);
void print_methods(const compare::SceneComparison& scene);

}  // namespace palpate::cli
