#pragma once
#include <string>

#include "palpate/store/run_reader.h"

/// XDMF sidecars: small XML files next to a run file that specify where in it the meshes and fields of each
/// step are stored.  ParaView before 5.12, which opens no time series of VTKHDF, opens these, and so do other
/// readers of XDMF 2 and 3.
namespace palpate::store {

/// Returns the path of a run file's sidecar: the same name with the ending .xdmf.
std::string xdmf_path(const std::string& run_path);

/// Returns the sidecar: a temporal collection with one spatial collection per step, which has one grid per
/// part; points and fields are hyperslabs of the run file's data sets, tetrahedra and triangles are complete
/// data sets.
/// @param run_file  path of the run file relative to the sidecar's folder
std::string xdmf_of(const RunReader& run, const std::string& run_file);

/// Writes the sidecar of a closed run file, atomically; none for a run without steps.
void write_xdmf(const std::string& run_path);

}  // namespace palpate::store
