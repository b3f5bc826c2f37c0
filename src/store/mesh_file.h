#pragma once
#include <string>

#include "palpate/mesh/mesh.h"

/// Native mesh file (.h5): `nodes`, n x 3 doubles [m], and `tets`, m x 4 integers from 0, in one HDF5 file.
/// read_mesh() also reads the tetrahedra of a model file (model_file.h).
namespace palpate::store {

/// Writes a mesh file.  @throws Error where it cannot be written
void write_mesh(const std::string& path, const TetMesh& mesh);

/// Reads the tetrahedra of a mesh or model file.  Orientation and quality are checked by the mesh part.
/// @throws Error with the file, the data set and the expectation, for a wrong shape or type, an index out of
///   range, a number that is not finite
TetMesh read_mesh(const std::string& path);

}  // namespace palpate::store
