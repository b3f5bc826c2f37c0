#include <algorithm>
#include <cmath>
#include <map>

#include "builder.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"
#include "rings.h"

// The ball is cut into 20 sectors over the faces of an icosahedron.  A sector is nearly a regular tetrahedron
// (edges 1 and 1.05), so its shells, cut like a tetrahedral lattice, give nearly regular elements everywhere.
// A point on a shell of frequency m is given by the weights (i, j, k), i + j + k = m, of the sector's three
// corner directions, and lies at the shell's radius.
namespace palpate::mesh {
namespace {

using Weights = Eigen::Vector3i;

struct Icosahedron {
  std::vector<Vec3> corners;
  std::vector<std::array<int, 3>> faces;  // outwards

  /// Corners (0, +-1, +-phi) and their cyclic permutations have edges of length 2; faces are the triples at
  /// that distance.
  Icosahedron() {
    const double phi = 0.5 * (1 + std::sqrt(5.0));
    for (int k = 0; k < 3; ++k)
      for (const double one : {-1.0, 1.0})
        for (const double golden : {-phi, phi}) {
          Vec3 p = Vec3::Zero();
          p[(k + 1) % 3] = one;
          p[(k + 2) % 3] = golden;
          corners.push_back(p);
        }
    const auto joined = [&](int a, int b) { return std::abs((at(a) - at(b)).norm() - 2) < 1e-9; };
    for (int a = 0; a < 12; ++a)
      for (int b = a + 1; b < 12; ++b)
        for (int c = b + 1; c < 12; ++c)
          if (joined(a, b) && joined(b, c) && joined(a, c))
            faces.push_back(at(a).dot(at(b).cross(at(c))) > 0 ? std::array{a, b, c} : std::array{a, c, b});
  }
  const Vec3& at(int corner) const { return corners[static_cast<std::size_t>(corner)]; }
};

const Icosahedron& icosahedron() {
  static const Icosahedron out;
  return out;
}

/// Nodes of one shell.  Points on an edge or corner of a sector are shared: they are identified by their
/// nonzero corner weights.
class Shell {
 public:
  Shell(const Ring& ring, Builder& builder) : ring_(ring) {
    for (std::size_t sector = 0; sector < 20; ++sector)
      for (int i = 0; i <= ring.frequency; ++i)
        for (int j = 0; i + j <= ring.frequency; ++j) {
          const Weights w(i, j, ring.frequency - i - j);
          if (const auto [it, is_new] = ids_.try_emplace(key(sector, w), 0); is_new)
            it->second = builder.add_point(position(sector, w));
        }
  }
  int node(std::size_t sector, const Weights& w) const { return ids_.at(key(sector, w)); }
  int frequency() const { return ring_.frequency; }

 private:
  using Key = std::array<std::pair<int, int>, 3>;  // (corner, weight), sorted

  static Key key(std::size_t sector, const Weights& w) {
    Key out{};
    for (int k = 0; k < 3; ++k)
      if (w[k] > 0)
        out[static_cast<std::size_t>(k)] = {icosahedron().faces[sector][static_cast<std::size_t>(k)] + 1,
                                            w[k]};
    std::sort(out.begin(), out.end());
    return out;
  }
  Vec3 position(std::size_t sector, const Weights& w) const {
    Vec3 p = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      p += w[k] * icosahedron().at(icosahedron().faces[sector][static_cast<std::size_t>(k)]);
    return ring_.frequency == 0 ? p : Vec3(ring_.radius * p.normalized());
  }

  Ring ring_;
  std::map<Key, int> ids_;
};

/// Calls use(corner) for all (i, j, k) >= 0 with i + j + k = sum.
template <class Use>
void for_each_place(int sum, Use use) {
  for (int i = 0; i <= sum; ++i)
    for (int j = 0; i + j <= sum; ++j) use(Weights(i, j, sum - i - j));
}
const Weights kUnit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// Adds four tetrahedra around the shortest of an octahedron's diagonals; pairs[i] are opposite corners.
void add_octahedron(Builder& builder, const std::array<std::array<int, 2>, 3>& pairs) {
  std::size_t axis = 0;
  const auto length = [&](std::size_t i) {
    return (builder.point(pairs[i][0]) - builder.point(pairs[i][1])).norm();
  };
  for (const std::size_t i : {1u, 2u})
    if (length(i) < length(axis) * (1 - 1e-9)) axis = i;  // ties go to the first, on every machine
  const auto &b = pairs[(axis + 1) % 3], &c = pairs[(axis + 2) % 3];
  for (const auto& [p, q] : {std::pair{b[0], c[0]}, {c[0], b[1]}, {b[1], c[1]}, {c[1], b[0]}})
    builder.add_tet(pairs[axis][0], pairs[axis][1], p, q);
}

/// Adds the elements between frequency m and m - 1: the layer of a tetrahedral lattice.
void add_layer(Builder& builder, std::size_t s, const Shell& outer, const Shell& inner) {
  const auto P = [&](const Weights& w) { return outer.node(s, w); };
  const auto Q = [&](const Weights& w) { return inner.node(s, w); };
  const Weights &x = kUnit[0], &y = kUnit[1], &z = kUnit[2];
  const int m = outer.frequency();
  for_each_place(m - 1, [&](const Weights& w) { builder.add_tet(Q(w), P(w + x), P(w + y), P(w + z)); });
  for_each_place(m - 2, [&](const Weights& w) {
    add_octahedron(builder, {{{Q(w + x), P(w + y + z)}, {Q(w + y), P(w + z + x)}, {Q(w + z), P(w + x + y)}}});
  });
  for_each_place(m - 3, [&](const Weights& w) {
    builder.add_tet(P(w + x + y + z), Q(w + x + y), Q(w + y + z), Q(w + z + x));
  });
}

/// Adds the elements between frequency m and m / 2: each inner triangle (a, b, c) faces four outer ones, with
/// corners at 2a, 2b, 2c and a+b, b+c, c+a.
void add_halving_layer(Builder& builder, std::size_t s, const Shell& outer, const Shell& inner) {
  const auto P = [&](const Weights& w) { return outer.node(s, w); };
  const auto Q = [&](const Weights& w) { return inner.node(s, w); };
  const auto add_triangle = [&](const Weights& a, const Weights& b, const Weights& c) {
    builder.add_tet(Q(a), P(2 * a), P(a + b), P(c + a));
    builder.add_tet(Q(b), P(2 * b), P(b + c), P(a + b));
    builder.add_tet(Q(c), P(2 * c), P(c + a), P(b + c));
    add_octahedron(builder, {{{Q(a), P(b + c)}, {Q(b), P(c + a)}, {Q(c), P(a + b)}}});
  };
  const Weights &x = kUnit[0], &y = kUnit[1], &z = kUnit[2];
  const int m = inner.frequency();
  for_each_place(m - 1, [&](const Weights& w) { add_triangle(w + x, w + y, w + z); });
  for_each_place(m - 2, [&](const Weights& w) { add_triangle(w + x + y, w + y + z, w + z + x); });
}

}  // namespace

int sphere_subdivisions(double radius, double element_size) {
  // An edge of the icosahedron spans an arc of 1.107 radii, the layers 1 radius in depth: 1.05 is between.
  return std::max(1, static_cast<int>(std::lround(1.05 * radius / element_size)));
}

TetMesh ball(double radius, double element_size, double grading) {
  Builder builder;
  const std::vector<Ring> layers = rings(radius, sphere_subdivisions(radius, element_size), grading);
  Shell outer(layers[0], builder);
  for (std::size_t i = 1; i < layers.size(); ++i) {
    Shell inner(layers[i], builder);
    const auto add = inner.frequency() == outer.frequency() - 1 ? add_layer : add_halving_layer;
    for (std::size_t sector = 0; sector < 20; ++sector) add(builder, sector, outer, inner);
    outer = std::move(inner);
  }
  return builder.tet_mesh();
}

TriMesh sphere(double radius, int subdivisions) {
  PALPATE_CHECK(subdivisions > 0 && radius > 0, "subdivisions = {}, radius = {}", subdivisions, radius);
  Builder builder;
  const Shell shell({subdivisions, radius}, builder);
  const Weights &x = kUnit[0], &y = kUnit[1], &z = kUnit[2];
  for (std::size_t s = 0; s < 20; ++s) {
    const auto add = [&](const Weights& a, const Weights& b, const Weights& c) {
      builder.faces.emplace_back(shell.node(s, a), shell.node(s, b), shell.node(s, c));
    };
    for_each_place(subdivisions - 1, [&](const Weights& w) { add(w + x, w + y, w + z); });
    for_each_place(subdivisions - 2, [&](const Weights& w) { add(w + x + y, w + y + z, w + z + x); });
  }
  return builder.tri_mesh();
}

}  // namespace palpate::mesh
