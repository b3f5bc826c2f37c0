// Foreign meshes that palpate model reads with its parsers and with CGAL. libgmsh's readers are not included.
#include "fuzz/input.h"
#include "fuzz/targets.h"
#include "model/foreign_files.h"

namespace palpate::fuzz {
namespace {

void read_source(const std::string& path) {
  is_read([&] {
    const model::SourceFile got = model::read_source(path);
    const Points& points = got.tets.tets.cols() > 0 ? got.tets.nodes : got.surface.vertices;
    const auto within = [&](const auto& cells) {
      return cells.size() == 0 || (cells.minCoeff() >= 0 && cells.maxCoeff() < points.cols());
    };
    promise(points.allFinite(), "coordinates are finite");
    promise(within(got.tets.tets) && within(got.surface.faces), "cells name points that are there");
  });
}

}  // namespace

void medit(std::string_view bytes) {
  const InputFile file("fuzz.meshb", bytes);
  read_source(file.path());
}

void vtu(std::string_view bytes) {
  const InputFile file("fuzz.vtu", bytes);
  read_source(file.path());
}

void vtk(std::string_view bytes) {
  const InputFile file("fuzz.vtk", bytes);
  read_source(file.path());
}

void polygons(std::string_view bytes) {
  const std::string ending = bytes.starts_with("ply") ? "ply" : bytes.starts_with("OFF") ? "off" : "stl";
  const InputFile file("fuzz." + ending, bytes);
  read_source(file.path());
}

}  // namespace palpate::fuzz
