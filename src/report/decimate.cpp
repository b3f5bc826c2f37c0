#include "decimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "palpate/core/error.h"

namespace palpate::report {
namespace {

using Cell = std::array<long, 3>;

/// Returns the vertices of each cell of a grid.
std::map<Cell, std::vector<int>> cells_of(const Points& vertices, double edge) {
  std::map<Cell, std::vector<int>> cells;
  for (int v = 0; v < static_cast<int>(vertices.cols()); ++v) {
    Cell cell{};
    for (int k = 0; k < 3; ++k)
      cell[static_cast<std::size_t>(k)] = static_cast<long>(std::floor(vertices(k, v) / edge));
    cells[cell].push_back(v);
  }
  return cells;
}

int nearest_to_mean(const Points& vertices, const std::vector<int>& members) {
  Vec3 mean = Vec3::Zero();
  for (const int v : members) mean += vertices.col(v);
  mean /= static_cast<double>(members.size());
  return *std::min_element(members.begin(), members.end(), [&](int a, int b) {
    return (vertices.col(a) - mean).squaredNorm() < (vertices.col(b) - mean).squaredNorm();
  });
}

/// Returns the faces that keep three different corners, without duplicates.
Faces faces_between(const Faces& faces, const std::vector<int>& cluster_of) {
  std::vector<std::array<int, 3>> kept;
  std::set<std::array<int, 3>> known;
  for (Eigen::Index f = 0; f < faces.cols(); ++f) {
    std::array<int, 3> face{};
    for (int k = 0; k < 3; ++k)
      face[static_cast<std::size_t>(k)] = cluster_of[static_cast<std::size_t>(faces(k, f))];
    std::array<int, 3> sorted = face;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2] || !known.insert(sorted).second) continue;
    kept.push_back(face);
  }
  Faces out(3, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t f = 0; f < kept.size(); ++f)
    for (int k = 0; k < 3; ++k) out(k, static_cast<Eigen::Index>(f)) = kept[f][static_cast<std::size_t>(k)];
  return out;
}

}  // namespace

CoarseSurface decimate(const Points& vertices, const Faces& faces, int most) {
  PALPATE_CHECK(most >= 8, "{} vertices cannot show a body", most);
  CoarseSurface out;
  if (vertices.cols() <= most) {
    out.kept.resize(static_cast<std::size_t>(vertices.cols()));
    std::iota(out.kept.begin(), out.kept.end(), 0);
    out.faces = faces;
    return out;
  }
  const Vec3 extent = vertices.rowwise().maxCoeff() - vertices.rowwise().minCoeff();
  // with this edge, the faces of a cube divide into `most` cells
  double edge = extent.maxCoeff() * std::sqrt(6.0 / most) / 2.0;
  std::map<Cell, std::vector<int>> cells = cells_of(vertices, edge);
  while (cells.size() > static_cast<std::size_t>(most)) cells = cells_of(vertices, edge *= 1.1);
  std::vector<int> cluster_of(static_cast<std::size_t>(vertices.cols()));
  for (const auto& [cell, members] : cells) {
    for (const int v : members) cluster_of[static_cast<std::size_t>(v)] = static_cast<int>(out.kept.size());
    out.kept.push_back(nearest_to_mean(vertices, members));
  }
  out.faces = faces_between(faces, cluster_of);
  return out;
}

}  // namespace palpate::report
