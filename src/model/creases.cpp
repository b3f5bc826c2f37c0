#include "model/creases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace palpate::model {
namespace {

constexpr double kSharpDeg = 50.0, kLeastShareOfDiagonal = 0.5, kLooseEnds = 0.05;

Vec3 normal(const TriMesh& surface, Eigen::Index face) {
  const auto corner = [&](int k) -> Vec3 { return surface.vertices.col(surface.faces(k, face)); };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
}

}  // namespace

std::optional<double> crease_angle(const TriMesh& surface) {
  std::map<std::array<int, 2>, Eigen::Index> first_face;
  std::vector<int> sharp_edges_at(static_cast<std::size_t>(surface.vertices.cols()), 0);
  double length = 0;
  for (Eigen::Index f = 0; f < surface.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = surface.faces(k, f), b = surface.faces((k + 1) % 3, f);
      const auto [at, fresh] = first_face.try_emplace({std::min(a, b), std::max(a, b)}, f);
      if (fresh ||
          normal(surface, at->second).dot(normal(surface, f)) > std::cos(kSharpDeg * std::numbers::pi / 180))
        continue;
      ++sharp_edges_at[static_cast<std::size_t>(a)];
      ++sharp_edges_at[static_cast<std::size_t>(b)];
      length += (surface.vertices.col(a) - surface.vertices.col(b)).norm();
    }
  const double diagonal =
      (surface.vertices.rowwise().maxCoeff() - surface.vertices.rowwise().minCoeff()).norm();
  const auto touched =
      std::count_if(sharp_edges_at.begin(), sharp_edges_at.end(), [](int n) { return n > 0; });
  const auto loose = std::count(sharp_edges_at.begin(), sharp_edges_at.end(), 1);
  if (length < kLeastShareOfDiagonal * diagonal ||
      static_cast<double>(loose) > kLooseEnds * static_cast<double>(touched))
    return std::nullopt;
  return kSharpDeg;
}

}  // namespace palpate::model
