#pragma once
#include <string>
#include <vector>

#include "palpate/store/run_file.h"

namespace palpate::cli {

/// Writes a row a point and state: time, state, part, number in the part's mesh file, position, displacement,
/// velocity, stress.  Ctrl-C ends it early.
void write_node_table(const store::RunReader& run, const std::vector<int>& steps,
                      const std::vector<int>& parts, const std::string& path);

/// Names of the tables that the run's scene had recorded beside its states (force.csv, bones.csv, ...).  An
/// older run of another scene may have left others in the folder; they are not among these.
std::vector<std::string> recorded_tables(const store::RunReader& run, const std::string& run_file);

}  // namespace palpate::cli
