#include "plane.h"

#include <cmath>

#include "palpate/core/error.h"
#include "remesh.h"

// The first triangulation cuts ears off the loop that a bridge from the outer loop to the hole and back
// makes of both; then the remesher inserts interior vertices.  The loops stay unchanged.
namespace palpate::shapes {
namespace {

double cross(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

double area(const std::vector<Point2>& loop) {
  double sum = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Point2 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

/// Cuts a simple polygon into ears: convex corners whose triangle contains no other vertex.  After each cut
/// the search moves on by one corner, to limit slivers.
std::vector<std::array<int, 3>> ears(const std::vector<Point2>& at, std::vector<int> loop) {
  std::vector<std::array<int, 3>> out;
  std::size_t i = 0, misses = 0;
  while (loop.size() > 3) {
    const std::size_t n = loop.size();
    PALPATE_CHECK(misses <= n, "no ear among {} corners", n);
    i %= n;
    const int a = loop[(i + n - 1) % n], b = loop[i], c = loop[(i + 1) % n];
    bool ear = cross(at[a], at[b], at[c]) > 0.0;
    for (std::size_t j = 0; ear && j < n; ++j) {
      const int p = loop[j];
      if (p == a || p == b || p == c) continue;
      if (cross(at[a], at[b], at[p]) >= 0.0 && cross(at[b], at[c], at[p]) >= 0.0 &&
          cross(at[c], at[a], at[p]) >= 0.0)
        ear = false;
    }
    if (!ear) {
      ++i, ++misses;
      continue;
    }
    out.push_back({a, b, c});
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(i));
    misses = 0;
    ++i;  // skip a corner: adjacent ears make fans of slivers
  }
  out.push_back({loop[0], loop[1], loop[2]});
  return out;
}

}  // namespace

// Euler: V - E + F = 0 for a ring, 3 F = 2 E - B with B edges on its rims, so F = 2 V - B = 2 (inside) + B;
// each face has the area sqrt(3)/4 edge^2.
int vertices_between(const std::vector<Point2>& outer, const std::vector<Point2>& hole, double edge) {
  const double faces = (area(outer) - area(hole)) / (std::sqrt(3.0) / 4.0 * edge * edge);
  return std::max(
      0, static_cast<int>(std::lround(0.5 * (faces - static_cast<double>(outer.size() + hole.size())))));
}

TriMesh between(const std::vector<Point2>& outer, const std::vector<Point2>& hole, int inside_vertices) {
  std::vector<Point2> at = outer;
  at.insert(at.end(), hole.begin(), hole.end());
  const int n = static_cast<int>(outer.size()), m = static_cast<int>(hole.size());
  std::vector<int> loop;
  for (int i = 0; i <= n; ++i) loop.push_back(i % n);
  for (int j = 0; j <= m; ++j) loop.push_back(n + (m - j) % m);
  const auto triangles = ears(at, loop);
  TriMesh mesh;
  mesh.vertices = Points::Zero(3, n + m);
  for (int i = 0; i < n + m; ++i) mesh.vertices.col(i).head<2>() = at[static_cast<std::size_t>(i)];
  mesh.faces.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t f = 0; f < triangles.size(); ++f)
    mesh.faces.col(static_cast<Eigen::Index>(f)) =
        Eigen::Vector3i(triangles[f][0], triangles[f][1], triangles[f][2]);

  RemeshRules rules;
  rules.inside = [](const Vec3& p) { return p.z(); };
  Remesher remesher(mesh, rules);
  const double edge =
      std::sqrt((area(outer) - area(hole)) / (std::sqrt(3.0) / 4.0 * (2.0 * inside_vertices + n + m)));
  remesher.delaunay();
  for (int round = 0; round < 6; ++round) remesher.round(edge), remesher.delaunay();
  remesher.trim(edge, n + m + inside_vertices);
  remesher.settle(6);
  return remesher.result();
}

}  // namespace palpate::shapes
