#pragma once
#include <string>

#include "source_file.h"

namespace palpate::model {

/// Readers of the formats in foreign_files.h; `format` is the name for messages.
SourceFile read_by_gmsh(const std::string& path, const std::string& format);
SourceFile read_by_cgal(const std::string& path, const std::string& format);  ///< .ply .off .stl
SourceFile read_meshb(const std::string& path);
SourceFile read_vtk(const std::string& path);
SourceFile read_vtk_xml(const std::string& path);  ///< .vtu .vtp

}  // namespace palpate::model
