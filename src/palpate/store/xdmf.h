#pragma once
#include <string>

#include "palpate/store/run_file.h"

/// XDMF sidecars: a small XML file beside a run file that says where in it the meshes and fields of each
/// instant stand.  ParaView before 5.12, which opens no time series of VTKHDF, opens these, and so do other
/// readers of XDMF 2 and 3.
namespace palpate::store {

/// Where the sidecar of a run file stands: the same name with the ending .xdmf.
std::string xdmf_path(const std::string& run_path);

/// The sidecar: a temporal collection with a spatial collection an instant, of one grid a part; points and
/// fields are hyperslabs of the run file's data sets, the tetrahedra and triangles are whole ones.
/// @param run_file  as the sidecar is to name it: relative to the sidecar's own folder
std::string xdmf_of(const RunReader& run, const std::string& run_file);

/// Writes the sidecar of a run file that is closed, whole or not at all; of one without a step none.
void write_xdmf(const std::string& run_path);

}  // namespace palpate::store
