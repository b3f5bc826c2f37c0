#pragma once
#include <string>

#include "palpate/mesh/mesh.h"
#include "palpate/mesh/quality.h"
#include "palpate/mesh/regions.h"
#include "palpate/mesh/spec.h"

namespace palpate::mesh {

/// Reads or generates the tetrahedra of a spec, and checks them: volumes are made positive (reported in
/// `flipped`); degenerate, duplicate, unreferenced or non-finite entries are rejected with file, element and
/// value. Formats by ending: .msh (Gmsh 2.2, 4.1 ASCII), .node/.ele (TetGen); .h5 is read by
/// store/mesh_file.h.
/// @param spec     file or generator
/// @param folder   base of a relative file path
/// @param report   receives the result of the check unless null
/// @param regions  receives the file's regions unless null; a generator has none
/// @throws Error for a spec, file or mesh that fails a check
TetMesh tet_mesh(const MeshSpec& spec, const std::string& folder, MeshReport* report = nullptr,
                 std::vector<MaterialRegion>* regions = nullptr);

/// Reads or generates a surface and checks it: .obj, or a generator ("ball", "box", "cylinder"); the result
/// is closed and oriented outwards.
/// @param spec    file or generator
/// @param folder  base of a relative file path
/// @param report  receives the result of the check unless null
/// @throws Error for a spec, file or surface that fails a check
TriMesh surface(const MeshSpec& spec, const std::string& folder, MeshReport* report = nullptr);

}  // namespace palpate::mesh
