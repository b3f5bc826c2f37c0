#include "model/foreign_files.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <vector>

#include "cells.h"
#include "format_readers.h"
#include "mesh/readers.h"
#include "palpate/core/error.h"
#include "store/mesh_file.h"
#include "store/model_file.h"

namespace palpate::model {
namespace {

struct Ending {
  const char* ending;
  const char* format;
};
constexpr Ending kEndings[] = {{".obj", "Wavefront OBJ"}, {".msh", "Gmsh"},    {".node", "TetGen"},
                               {".ele", "TetGen"},        {".mesh", "Medit"},  {".meshb", "Medit"},
                               {".vtk", "legacy VTK"},    {".vtu", "VTK XML"}, {".vtp", "VTK XML"},
                               {".stl", "STL"},           {".ply", "PLY"},     {".off", "OFF"},
                               {".h5", "palpate HDF5"}};

SourceFile of_tets(mesh::TetFile file, std::string format) {
  SourceFile out;
  out.tets = std::move(file.mesh);
  out.regions = std::move(file.regions);
  out.from = std::move(file.from);
  out.format = std::move(format);
  return out;
}

/// Reads Gmsh's ASCII formats 2 and 4.1 by palpate's reader, which reports lines and reads tetrahedra only;
/// all other files by libgmsh.
SourceFile read_msh(const std::string& path) {
  std::ifstream in(path);
  std::string section, version;
  int binary = 1;
  in >> section >> version >> binary;
  if (section == "$NOD") return read_by_gmsh(path, "Gmsh 1");
  const std::string format = fmt::format("Gmsh {}{}", version, binary == 0 ? "" : " binary");
  if (section == "$MeshFormat" && binary == 0 && (version.starts_with("2") || version == "4.1"))
    if (mesh::TetFile file = mesh::read_gmsh(path); file.mesh.tets.cols() > 0)
      return of_tets(std::move(file), format);
  return read_by_gmsh(path, format);
}

}  // namespace

const std::vector<std::string>& known_region_arrays() {
  static const std::vector<std::string> names = {
      "gmsh:physical", "medit:ref", "CellEntityIds", "MaterialIds", "MaterialId", "Material",
      "RegionIds",     "RegionId",  "Region",        "PhysicalIds", "attribute"};
  return names;
}

std::string known_endings() {
  std::string out;
  for (const Ending& known : kEndings) out += fmt::format("{}{}", out.empty() ? "" : " ", known.ending);
  return out;
}

SourceFile read_source(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) fail("{}: no such file", path);
  const std::string ending = lower(std::filesystem::path(path).extension().string());
  const auto known = std::find_if(std::begin(kEndings), std::end(kEndings),
                                  [&](const Ending& e) { return ending == e.ending; });
  if (known == std::end(kEndings))
    fail("{}: unknown ending \"{}\"; these are read: {}", path, ending, known_endings());
  if (ending == ".msh") return read_msh(path);
  if (ending == ".vtk") return read_vtk(path);
  if (ending == ".vtu" || ending == ".vtp") return read_vtk_xml(path);
  if (ending == ".meshb") return read_meshb(path);
  if (ending == ".ply" || ending == ".off" || ending == ".stl") return read_by_cgal(path, known->format);
  if (ending == ".node" || ending == ".ele") return of_tets(mesh::read_tetgen(path), known->format);
  SourceFile out;
  out.format = known->format;
  out.from.source = path;
  if (ending == ".h5") {
    out.tets = store::read_mesh(path);
    out.regions = store::read_regions(path, static_cast<int>(out.tets.tets.cols()));
  } else if (ending == ".obj") {
    mesh::SurfaceFile file = mesh::read_obj(path);
    out.surface = std::move(file.mesh);
    out.from = std::move(file.from);
    out.polygons = file.polygons;
  } else {
    out = read_by_gmsh(path, known->format);
  }
  return out;
}

}  // namespace palpate::model
