#pragma once
#include <string>
#include <utility>
#include <vector>

#include "palpate/store/run_reader.h"

/// VTK XML files, which every ParaView opens: one .vtu per recorded state, and a .pvd that combines them into
/// a time series.
namespace palpate::store {

/// Returns one recorded state as an unstructured grid with all data of the run file: displacement [m],
/// velocity [m/s] and stress [Pa] at the points, the part's index in the run at the cells, the time as a
/// field. Arrays are base64, so that any XML parser reads the file.
/// @param parts  indices of the parts to write
/// @throws Error for a step that does not exist
std::string vtu_of(const RunReader& run, int step, const std::vector<int>& parts);

/// Returns the .pvd collection of such files.
/// @param files  time [s] and name relative to the collection's folder
std::string pvd_of(const std::vector<std::pair<double, std::string>>& files);

}  // namespace palpate::store
