// Native mesh readers, with the checks that follow them.
#include "fuzz/input.h"
#include "fuzz/targets.h"
#include "palpate/mesh/source.h"

namespace palpate::fuzz {
namespace {

void promise_whole(const Points& points, const auto& cells) {
  promise(points.allFinite(), "coordinates are finite");
  promise(cells.size() == 0 || (cells.minCoeff() >= 0 && cells.maxCoeff() < points.cols()),
          "cells name points that are there");
}

/// Reads, repairs and checks a mesh as a scene does.
void read_tets(const std::string& path) {
  is_read([&] {
    MeshSpec spec;
    spec.file = path;
    std::vector<MaterialRegion> regions;
    const TetMesh mesh = mesh::tet_mesh(spec, "", nullptr, &regions);
    promise_whole(mesh.nodes, mesh.tets);
    for (const MaterialRegion& region : regions)
      for (const int tet : region.tets)
        promise(tet >= 0 && tet < mesh.tets.cols(), "regions name tetrahedra that are there");
  });
}

}  // namespace

void obj(std::string_view bytes) {
  const InputFile file("fuzz.obj", bytes);
  is_read([&] {
    MeshSpec spec;
    spec.file = file.path();
    const TriMesh mesh = mesh::surface(spec, "");
    promise_whole(mesh.vertices, mesh.faces);
  });
}

void gmsh(std::string_view bytes) {
  const InputFile file("fuzz.msh", bytes);
  read_tets(file.path());
}

void tetgen(std::string_view bytes) {
  constexpr std::string_view kBetween = "====\n";
  const std::size_t cut = bytes.find(kBetween);
  const bool both = cut != std::string_view::npos;
  const InputFile nodes("fuzz.node", bytes.substr(0, cut)),
      elements("fuzz.ele", both ? bytes.substr(cut + kBetween.size()) : std::string_view{});
  read_tets(elements.path());
}

}  // namespace palpate::fuzz
