#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "builder.h"
#include "lattice.h"
#include "palpate/mesh/generators.h"
#include "rings.h"

// A disc of six sectors in rings, extruded along z into prisms.  A prism over (a, b, c), a < b < c, is the
// tetrahedra a b c c', a b b' c', a a' b' c': the diagonal of each of its quads starts at the smaller index
// at the bottom, so that neighbours agree (Dompierre et al. 1999).
namespace palpate::mesh {
namespace {

struct Disc {
  std::vector<Eigen::Vector2d> points;
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise
  int rim = 0;                                // points 0 to rim - 1 lie on the circumference
};

/// Indices of a ring's points: six sectors of `frequency` parts, from `first` on; the centre has one point.
struct RingPoints {
  int first, frequency;
  int operator()(int i) const { return frequency == 0 ? first : first + i % (6 * frequency); }
};

/// Adds the triangles between frequency m and m - 1.
void add_ring(Disc& disc, const RingPoints& P, const RingPoints& Q) {
  const int m = P.frequency;
  for (int s = 0; s < 6; ++s)
    for (int i = 0; i < m; ++i) {
      const int p = s * m + i, q = s * (m - 1) + i;
      disc.triangles.push_back({P(p), P(p + 1), Q(q)});
      if (i + 1 < m) disc.triangles.push_back({P(p + 1), Q(q + 1), Q(q)});
    }
}

/// Adds the triangles between frequency m and m / 2: three per inner part.
void add_halving_ring(Disc& disc, const RingPoints& P, const RingPoints& Q) {
  for (int i = 0; i < 6 * Q.frequency; ++i) {
    disc.triangles.push_back({Q(i), P(2 * i), P(2 * i + 1)});
    disc.triangles.push_back({Q(i), P(2 * i + 1), Q(i + 1)});
    disc.triangles.push_back({Q(i + 1), P(2 * i + 1), P(2 * i + 2)});
  }
}

Disc make_disc(double radius, double element_size, double grading) {
  const int frequency = std::max(1, static_cast<int>(std::lround(1.05 * radius / element_size)));
  Disc out;
  out.rim = 6 * frequency;
  RingPoints outer{0, 0};
  for (const Ring& ring : rings(radius, frequency, grading)) {
    const RingPoints inner{static_cast<int>(out.points.size()), ring.frequency};
    for (int i = 0; i < std::max(1, 6 * ring.frequency); ++i) {
      const double angle = ring.frequency == 0 ? 0 : std::numbers::pi * i / (3.0 * ring.frequency);
      out.points.emplace_back(ring.radius * std::cos(angle), ring.radius * std::sin(angle));
    }
    if (outer.frequency > 0)
      (inner.frequency == outer.frequency - 1 ? add_ring : add_halving_ring)(out, outer, inner);
    outer = inner;
  }
  return out;
}

/// Places the disc's points at every height.
Builder extruded(const Disc& disc, const std::vector<double>& z) {
  Builder out;
  for (const double height : z)
    for (const auto& p : disc.points) out.add_point({p.x(), p.y(), height});
  return out;
}

}  // namespace

TetMesh cylinder(double radius, double length, double element_size, double grading) {
  const Disc disc = make_disc(radius, element_size, grading);
  const auto z = graded_coordinates(length, graded_cells(length, element_size, grading), grading);
  Builder builder = extruded(disc, z);
  const int up = static_cast<int>(disc.points.size());
  for (int layer = 0; layer + 1 < static_cast<int>(z.size()); ++layer)
    for (auto [a, b, c] : disc.triangles) {
      std::array<int, 3> n = {a, b, c};
      std::sort(n.begin(), n.end());
      for (int& i : n) i += layer * up;
      builder.add_tet(n[0], n[1], n[2], n[2] + up);
      builder.add_tet(n[0], n[1], n[1] + up, n[2] + up);
      builder.add_tet(n[0], n[0] + up, n[1] + up, n[2] + up);
    }
  return builder.tet_mesh();
}

TriMesh cylinder_surface(double radius, double length, double element_size, double grading) {
  const Disc disc = make_disc(radius, element_size, grading);
  const auto z = graded_coordinates(length, graded_cells(length, element_size, grading), grading);
  Builder builder = extruded(disc, z);
  const int up = static_cast<int>(disc.points.size()), top = up * (static_cast<int>(z.size()) - 1);
  for (const auto& [a, b, c] : disc.triangles) {
    builder.faces.emplace_back(a, c, b);
    builder.faces.emplace_back(top + a, top + b, top + c);
  }
  for (int base = 0; base < top; base += up)
    for (int i = 0; i < disc.rim; ++i) {
      const int a = base + i, b = base + (i + 1) % disc.rim;
      if (a < b) {
        builder.faces.emplace_back(a, b, b + up);
        builder.faces.emplace_back(a, b + up, a + up);
      } else {
        builder.faces.emplace_back(a, b, a + up);
        builder.faces.emplace_back(b, b + up, a + up);
      }
    }
  return builder.tri_mesh();
}

}  // namespace palpate::mesh
