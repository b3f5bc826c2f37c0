#pragma once
#include <string>
#include <vector>

/// Columns of the tables in a comparison's folder; names carry units.  compare writes them, followed by all
/// other numbers of a run; report reads them.
namespace palpate::store {

/// Returns the columns of compare.csv: one line per point.
const std::vector<std::string>& compare_columns();
/// Returns the columns of restarts.csv: cost of contact refreshes for each integrator.
const std::vector<std::string>& restart_columns();

}  // namespace palpate::store
