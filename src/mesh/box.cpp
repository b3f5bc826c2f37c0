#include "builder.h"
#include "lattice.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

// A cube is five tetrahedra: one at each corner of even i + j + k, and the regular one between the four odd
// corners.  Every diagonal of a face then joins two odd nodes in both adjacent cells, so that faces match.
namespace palpate::mesh {
namespace {

struct Lattice {
  std::array<int, 3> cells;
  Builder builder;

  Lattice(const Vec3& size, const std::array<int, 3>& n, double grading) : cells(n) {
    PALPATE_CHECK(n[0] > 0 && n[1] > 0 && n[2] > 0 && size.minCoeff() > 0, "cells {} {} {}", n[0], n[1],
                  n[2]);
    const auto x = graded_coordinates(size.x(), n[0], grading),
               y = graded_coordinates(size.y(), n[1], grading),
               z = graded_coordinates(size.z(), n[2], grading);
    for (const double zk : z)
      for (const double yj : y)
        for (const double xi : x) builder.add_point({xi, yj, zk});
  }
  int node(const std::array<int, 3>& at) const {
    return at[0] + (cells[0] + 1) * (at[1] + (cells[1] + 1) * at[2]);
  }
};

bool is_odd(const std::array<int, 3>& at) { return (at[0] + at[1] + at[2]) % 2 != 0; }

void add_cell(Lattice& lattice, int i, int j, int k) {
  const auto corner = [&](int bits) {
    return std::array{i + (bits & 1), j + (bits >> 1 & 1), k + (bits >> 2)};
  };
  const auto node = [&](int bits) { return lattice.node(corner(bits)); };
  const int odd = is_odd(corner(0)) ? 0 : 1;  // bits of the odd corners: {0, 3, 5, 6} or {1, 2, 4, 7}
  for (int bits = 0; bits < 8; ++bits)
    if (!is_odd(corner(bits)))
      lattice.builder.add_tet(node(bits), node(bits ^ 1), node(bits ^ 2), node(bits ^ 4));
  lattice.builder.add_tet(node(odd), node(odd ^ 3), node(odd ^ 5), node(odd ^ 6));
}

/// Adds the quads of the side where coordinate `axis` is 0 or at its end, cut between their odd corners.
void add_side(Lattice& lattice, std::size_t axis, bool at_end) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (int b = 0; b < lattice.cells[v]; ++b)
    for (int a = 0; a < lattice.cells[u]; ++a) {
      const auto corner = [&](int da, int db) {
        std::array<int, 3> at{};
        at[axis] = at_end ? lattice.cells[axis] : 0;
        at[u] = a + da;
        at[v] = b + db;
        return at;
      };
      std::array<int, 4> quad = {lattice.node(corner(0, 0)), lattice.node(corner(1, 0)),
                                 lattice.node(corner(1, 1)), lattice.node(corner(0, 1))};
      // Counter-clockwise seen from outside; 0 and 2 stay opposite.
      if (!at_end) std::swap(quad[1], quad[3]);
      auto& faces = lattice.builder.faces;
      if (is_odd(corner(0, 0))) {
        faces.emplace_back(quad[0], quad[1], quad[2]);
        faces.emplace_back(quad[0], quad[2], quad[3]);
      } else {
        faces.emplace_back(quad[0], quad[1], quad[3]);
        faces.emplace_back(quad[1], quad[2], quad[3]);
      }
    }
}

}  // namespace

TetMesh box(const Vec3& size, const std::array<int, 3>& cells, double grading) {
  Lattice lattice(size, cells, grading);
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) add_cell(lattice, i, j, k);
  return lattice.builder.tet_mesh();
}

TriMesh box_surface(const Vec3& size, const std::array<int, 3>& cells, double grading) {
  Lattice lattice(size, cells, grading);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool at_end : {false, true}) add_side(lattice, axis, at_end);
  return lattice.builder.tri_mesh();
}

TetMesh corner_tet(const Vec3& size) {
  Builder builder;
  builder.add_point(Vec3::Zero());
  for (int k = 0; k < 3; ++k) builder.add_point(size[k] * Vec3::Unit(k));
  builder.add_tet(0, 1, 2, 3);
  return builder.tet_mesh();
}

}  // namespace palpate::mesh
