#include "bones/revolved.h"

#include <cmath>
#include <numbers>

namespace palpate::bones {
namespace {
using std::numbers::pi;
constexpr int kMeridians = 24;
}  // namespace

TriMesh revolved(const std::vector<Eigen::Vector2d>& profile) {
  const int rings = static_cast<int>(profile.size()) - 2, n = kMeridians;
  TriMesh out;
  out.vertices.resize(3, n * rings + 2);
  out.faces.resize(3, 2 * n * rings);
  const auto vertex = [n](int ring, int i) { return 1 + ring * n + i % n; };
  out.vertices.col(0) = Vec3(0.0, 0.0, profile.front().y());
  for (int r = 0; r < rings; ++r)
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector2d& p = profile[static_cast<std::size_t>(r) + 1];
      out.vertices.col(vertex(r, i)) =
          Vec3(p.x() * std::cos(2.0 * pi * i / n), p.x() * std::sin(2.0 * pi * i / n), p.y());
    }
  const int last = n * rings + 1;
  out.vertices.col(last) = Vec3(0.0, 0.0, profile.back().y());
  int f = 0;
  for (int i = 0; i < n; ++i) {  // the profile goes upwards: rings are counter-clockwise seen from outside
    out.faces.col(f++) << 0, vertex(0, i + 1), vertex(0, i);
    for (int r = 0; r + 1 < rings; ++r) {
      out.faces.col(f++) << vertex(r, i), vertex(r, i + 1), vertex(r + 1, i + 1);
      out.faces.col(f++) << vertex(r, i), vertex(r + 1, i + 1), vertex(r + 1, i);
    }
    out.faces.col(f++) << vertex(rings - 1, i), vertex(rings - 1, i + 1), last;
  }
  return out;
}

}  // namespace palpate::bones
