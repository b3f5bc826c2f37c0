#pragma once
#include <string>
#include <vector>

/// Columns of the tables that a comparison leaves in its folder, units in their names.  compare writes them,
/// followed by every other number of a run; report reads them.
namespace palpate::store {

/// compare.csv: one line a point.
const std::vector<std::string>& compare_columns();
/// restarts.csv: what contact refreshes cost each integrator.
const std::vector<std::string>& restart_columns();

}  // namespace palpate::store
