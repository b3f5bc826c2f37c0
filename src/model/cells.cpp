#include "cells.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "palpate/core/error.h"

namespace palpate::model {
namespace {

void check_corners(const std::vector<int>& corners, std::size_t element, const Cells& cells,
                   const std::string& path) {
  for (const int corner : corners)
    if (corner < 0 || static_cast<std::size_t>(corner) >= cells.points.size())
      fail("{}: element {} (counted from 0) refers to point {}, but the file has {} points", path, element,
           corner, cells.points.size());
}

/// Renumbers the elements' corners to the points in use, which are stored in `points`.
template <std::size_t N>
Eigen::Matrix<int, static_cast<int>(N), Eigen::Dynamic> compact(
    const std::vector<std::array<int, N>>& elements, const Cells& cells, const std::string& path,
    Points& points, mesh::Provenance& from) {
  std::vector<int> place(cells.points.size(), -1);
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (const int corner : elements[e]) place[static_cast<std::size_t>(corner)] = 0;
  int used = 0;
  points.resize(3, std::count(place.begin(), place.end(), 0));
  for (std::size_t i = 0; i < place.size(); ++i)
    if (place[i] == 0) {
      if (!cells.points[i].allFinite()) fail("{}: point {} is not finite; write the mesh again", path, i);
      points.col(used) = cells.points[i];
      from.node_number.push_back(cells.point_numbers.empty() ? static_cast<long>(i) : cells.point_numbers[i]);
      place[i] = used++;
    }
  Eigen::Matrix<int, static_cast<int>(N), Eigen::Dynamic> out(static_cast<int>(N),
                                                              static_cast<Eigen::Index>(elements.size()));
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (std::size_t k = 0; k < N; ++k)
      out(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(e)) =
          place[static_cast<std::size_t>(elements[e][k])];
  return out;
}

}  // namespace

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

void Cells::unread(std::string_view what) {
  for (auto& [name, count] : unread_)
    if (name == what) {
      ++count;
      return;
    }
  unread_.emplace_back(what, 1);
}

SourceFile Cells::finish(std::string format) const {
  if (!unread_.empty())
    fail(
        "{}: contains {} {}, which are not supported; use linear tetrahedra or a surface of linear triangles",
        path_, unread_[0].second, unread_[0].first);
  if (tets_.empty() && polygons_.empty())
    fail("{}: holds neither tetrahedra nor triangles ({} points)", path_, points.size());
  SourceFile out;
  out.format = std::move(format);
  if (!tets_.empty()) {
    out.from.source = path_;
    for (std::size_t t = 0; t < tets_.size(); ++t)
      check_corners({tets_[t].begin(), tets_[t].end()}, t, *this, path_);
    out.tets.tets = compact(tets_, *this, path_, out.tets.nodes, out.from);
    PALPATE_CHECK(labels.empty() || labels.size() == tets_.size(),
                  "{}: {} numbers of regions for {} tetrahedra", path_, labels.size(), tets_.size());
    out.regions = groups.empty() ? mesh::regions_of_labels(labels, label_names)
                                 : mesh::regions_of_groups(groups, label_names, tets_.size());
  } else {
    out.from = mesh::surface_provenance(path_);
    std::vector<std::array<int, 3>> triangles;
    for (std::size_t p = 0; p < polygons_.size(); ++p) {
      if (polygons_[p].size() < 3) continue;  // an edge or a point
      check_corners(polygons_[p], p, *this, path_);
      mesh::append_polygon(points, polygons_[p], triangles, out.polygons);
      out.from.element_number.resize(triangles.size(), static_cast<long>(p));
    }
    out.surface.faces = compact(triangles, *this, path_, out.surface.vertices, out.from);
  }
  return out;
}

}  // namespace palpate::model
