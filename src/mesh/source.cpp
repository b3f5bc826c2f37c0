#include "palpate/mesh/source.h"

#include <cmath>
#include <filesystem>

#include "mesh/readers.h"
#include "mesh/size_check.h"
#include "mesh/surface_checks.h"
#include "mesh/tet_checks.h"
#include "palpate/core/log.h"
#include "palpate/mesh/generators.h"

namespace palpate::mesh {
namespace {

/// Whether the spec has a file.
/// @throws Error unless exactly one of file and generator is given
bool is_file(const MeshSpec& spec) {
  if (!spec.file.empty() && !spec.generator.empty())
    fail("mesh: file = \"{}\" and generator = \"{}\" exclude each other; give one", spec.file,
         spec.generator);
  if (spec.file.empty() && spec.generator.empty())
    fail("mesh: neither file nor generator is given; give one (generators: box, ball, cylinder, tet)");
  if (!MeshRanges::scale.holds(spec.factor()))
    fail("mesh: scale = {} {}", spec.factor(), MeshRanges::scale.demand());
  return !spec.file.empty();
}

std::string ending(const std::string& path) {
  std::string out = std::filesystem::path(path).extension().string();
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

TetFile read_tets(const std::string& path) {
  const std::string kind = ending(path);
  if (kind == ".msh") return read_gmsh(path);
  if (kind == ".node" || kind == ".ele") return read_tetgen(path);
  if (kind == ".obj")
    fail(
        "{}: an .obj contains a surface, but a soft body needs tetrahedra (.msh, .node/.ele); convert it to "
        "a model: palpate model {} -o MODEL.h5",
        path, path);
  fail(
      "{}: unknown ending \"{}\" for tetrahedra; .msh (Gmsh), .node and .ele (TetGen) and models (.h5) are "
      "read; palpate model makes a model of STL, PLY, OFF, VTK, VTU and Medit files",
      path, kind);
}

SurfaceFile read_surface(const std::string& path) {
  if (const std::string kind = ending(path); kind != ".obj")
    fail("{}: unknown ending \"{}\" for a surface; .obj is read", path, kind);
  return read_obj(path);
}

/// Rejects a size that is implausible in metres if the scene specifies no scale.
void check_size(const MeshSpec& spec, const Points& points, const std::string& path, const char* what) {
  if (spec.scale) return;
  if (const auto doubt = doubt_about_size(points))
    fail(
        "{}: the {} is {:.3g} m large; if this is intended, add scale = 1 to file = \"{}\", or if the file "
        "is in {}, scale = {}",
        path, what, doubt->size_m, spec.file, doubt->other_unit, doubt->factor);
}

std::string generator_name(const MeshSpec& spec) { return fmt::format("generator \"{}\"", spec.generator); }

}  // namespace

TetMesh tet_mesh(const MeshSpec& spec, const std::string& folder, MeshReport* report,
                 std::vector<MaterialRegion>* regions) {
  TetFile out;
  if (is_file(spec)) {
    out = read_tets((std::filesystem::path(folder) / spec.file).string());
    check_size(spec, out.mesh.nodes, out.from.source, "body");
    out.mesh.nodes *= spec.factor();
  } else {
    out.mesh = find(tet_generators(), spec.generator, "mesh generator").make(spec);
    out.from.source = generator_name(spec);
  }
  const MeshReport found = check_tets(out.mesh, out.from);
  if (report) *report = found;
  if (regions) *regions = std::move(out.regions);
  return std::move(out.mesh);
}

TriMesh surface(const MeshSpec& spec, const std::string& folder, MeshReport* report) {
  SurfaceFile out;
  if (is_file(spec)) {
    out = read_surface((std::filesystem::path(folder) / spec.file).string());
    if (const std::string crossing = crossing_text(out.polygons, out.from); !crossing.empty())
      fail("{}", crossing);
    if (const std::string warped = warped_text(out.polygons, out.from); !warped.empty())
      log::warn("{}", warped);
    check_size(spec, out.mesh.vertices, out.from.source, "tool");
    out.mesh.vertices *= spec.factor();
  } else {
    out.mesh = find(surface_generators(), spec.generator, "surface generator").make(spec);
    out.from = surface_provenance(generator_name(spec));
  }
  const MeshReport found = check_surface(out.mesh, out.from);
  if (report) *report = found;
  return std::move(out.mesh);
}

}  // namespace palpate::mesh
