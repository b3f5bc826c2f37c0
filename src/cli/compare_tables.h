#pragma once
#include "palpate/compare/compare.h"
#include "palpate/report/table.h"

/// What `palpate compare` prints of one scene.
namespace palpate::cli {

/// How it was made, and how far it can be trusted.
void print_reference(const compare::SceneComparison& scene);
/// A line a point, neighbouring rungs that failed alike in one; only their number where a screen cannot hold
/// them.
void print_points(const compare::SceneComparison& scene);
/// A line a ladder: fitted order, best error, what each of report::kTargets costs.  Then who is cheapest.
/// @param table  the scene's lines of compare.csv
void print_prices(const report::Table& table, double reference_error);
void print_restarts(const compare::SceneComparison& scene);
void print_exchange(const compare::SceneComparison& scene);
void print_methods(const compare::SceneComparison& scene);

}  // namespace palpate::cli
