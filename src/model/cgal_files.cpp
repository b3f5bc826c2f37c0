#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/polygon_soup_io.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <sstream>

#include "cells.h"
#include "core/sandbox.h"
#include "format_readers.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"

namespace palpate::model {
namespace {

/// Converts an ASCII STL file to lower case, because CGAL recognises only lower-case keywords.  A binary file
/// has a header of 80 bytes, a count, and 50 bytes per triangle; it may begin with "solid" too and is left
/// unchanged.
std::string lower_keywords(std::string stl) {
  constexpr std::size_t kHead = 80, kTriangle = 50;
  std::uint32_t triangles = 0;
  if (stl.size() >= kHead + sizeof triangles) std::memcpy(&triangles, stl.data() + kHead, sizeof triangles);
  if (stl.size() == kHead + sizeof triangles + kTriangle * triangles) return stl;
  return lower(std::move(stl));
}

SourceFile soup_in(const std::string& path, const std::string& format) {
  std::vector<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> faces;
  bool good = false;
  try {
    if (format == "STL") {
      std::istringstream text(lower_keywords(store::read_file(path)));
      good = CGAL::IO::read_STL(text, points, faces);
    } else {
      good = CGAL::IO::read_polygon_soup(path, points, faces);
    }
  } catch (const std::exception&) { good = false; }
  if (!good || points.empty())
    fail("{}: cannot be read as {}; check that it is complete and of that format", path, format);
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
  return rehearsed(path, "CGAL", [&] { return soup_in(path, format); });
}

}  // namespace palpate::model
