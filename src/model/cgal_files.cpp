#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/polygon_soup_io.h>

#include "cells.h"
#include "palpate/core/error.h"
#include "palpate/core/rehearsal.h"

namespace palpate::model {
namespace {

SourceFile read_here(const std::string& path, const std::string& format) {
  std::vector<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> faces;
  bool good = false;
  try {
    good = CGAL::IO::read_polygon_soup(path, points, faces);
  } catch (const std::exception&) { good = false; }
  if (!good || points.empty())
    fail("{}: cannot be read as {}; is it whole, and of that format?", path, format);
  Cells cells(path);
  for (const auto& p : points) cells.points.emplace_back(p.x(), p.y(), p.z());
  for (const auto& face : faces) {
    std::vector<int> corners;
    for (const std::size_t corner : face) corners.push_back(static_cast<int>(corner));
    cells.polygon(corners);
  }
  return cells.finish(format);
}

}  // namespace

SourceFile read_by_cgal(const std::string& path, const std::string& format) {
  return rehearsed(path, "CGAL", [&] { return read_here(path, format); });
}

}  // namespace palpate::model
