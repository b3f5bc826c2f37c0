#pragma once
#include <string>
#include <vector>

#include "palpate/store/run_file.h"

namespace palpate::cli {

/// Writes a table with one row per point and state: time, state, part, number in the mesh file of the part,
/// position, displacement, velocity, stress. Ctrl-C ends the table early.
void write_node_table(const store::RunReader& run, const std::vector<int>& steps,
                      const std::vector<int>& parts, const std::string& path);

/// Returns the names of the tables that the scene of the run recorded in addition to its states (force.csv,
/// bones.csv, ...). Tables that an older run of another scene left in the folder are not included.
std::vector<std::string> recorded_tables(const store::RunReader& run, const std::string& run_file);

}  // namespace palpate::cli
