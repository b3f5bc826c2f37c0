#pragma once
#include <string>

#include "palpate/mesh/mesh.h"

/// The native mesh file (.h5): `nodes`, n x 3 doubles [m], and `tets`, m x 4 integers from 0, in one HDF5
/// file. The tetrahedra of a model file (model_file.h) are read by the same function.
namespace palpate::store {

void write_mesh(const std::string& path, const TetMesh& mesh);

/// @throws Error with the file, the data set, and what was expected: wrong shape or type, an index out of
///   range, a number that is not finite.
/// Orientation and quality are the mesh part's to check.
TetMesh read_mesh(const std::string& path);

}  // namespace palpate::store
