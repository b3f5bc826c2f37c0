#pragma once
#include <string>
#include <utility>
#include <vector>

#include "palpate/store/run_file.h"

/// VTK's XML files, which every ParaView opens: a .vtu a recorded state, and a .pvd that makes a time series
/// of them.
namespace palpate::store {

/// One recorded state as an unstructured grid with all that the run file holds: displacement [m], velocity
/// [m/s] and stress [Pa] at the points, the part's number in the run at the cells, the time as a field.
/// Arrays are base64, so that the file is XML that any parser reads.
/// @param parts  which parts of the run, by their numbers
/// @throws Error for a step that is not there
std::string vtu_of(const RunReader& run, int step, const std::vector<int>& parts);

/// The collection of such files.
/// @param files  time [s] and name, relative to the collection's folder
std::string pvd_of(const std::vector<std::pair<double, std::string>>& files);

}  // namespace palpate::store
