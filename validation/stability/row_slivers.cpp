#include <cmath>

#include "linear.h"
#include "palpate/mesh/generators.h"

// A clamped block (row_material.cpp) with elements that no mesher should generate.
// - Dihedral angle of 0.1 degree: an apex so low over a face of the cube that the three angles at the
//   edges of this face are 0.1 degree.
// - Volume ratio of 1e6: the corner of a corner tetrahedron is cut off at a hundredth of its edges; the
//   frustum below is three tetrahedra.
//
// Both are linear: modes, and so expectations, follow from linear_theory.cpp. A sliver with the height e
// causes frequencies of about c/e and a condition of 1e8: a test for the matrices, and for the explicit
// limits.

namespace palpate::stability {
namespace {

constexpr double kDampingRatio = 0.05, kH = 0.01;

void append_node(TetMesh& mesh, const Vec3& node) {
  mesh.nodes.conservativeResize(3, mesh.nodes.cols() + 1);
  mesh.nodes.rightCols<1>() = node;
}

void append_tet(TetMesh& mesh, int a, int b, int c, int d) {
  const auto x = [&](int i) { return Vec3(mesh.nodes.col(i)); };
  if ((x(b) - x(a)).cross(x(c) - x(a)).dot(x(d) - x(a)) < 0.0) std::swap(c, d);
  mesh.tets.conservativeResize(4, mesh.tets.cols() + 1);
  mesh.tets.rightCols<1>() << a, b, c, d;
}

/// Returns the only tetrahedron at an upper node that belongs to no other, and this node in `corner`; -1 if
/// none.
int only_tet_at(const TetMesh& mesh, int& corner) {
  for (corner = 0; corner < mesh.nodes.cols(); ++corner) {
    if (mesh.nodes(2, corner) < 0.0) continue;
    const auto uses = (mesh.tets.array() == corner).colwise().any();
    if (uses.count() != 1) continue;
    for (int t = 0; t < mesh.tets.cols(); ++t)
      if ((mesh.tets.col(t).array() == corner).any()) return t;
  }
  return -1;
}

}  // namespace

TetMesh mesh_with_flat_element() {
  TetMesh mesh = mesh::box(Vec3::Constant(1.0), {1, 1, 1});
  int corner = 0;
  const int tet = only_tet_at(mesh, corner);
  int top[3], count = 0;  // Face of this element on the cube's upper side.
  for (int k = 0; k < 4; ++k)
    if (mesh.nodes(2, mesh.tets(k, tet)) > 0.0 && count < 3) top[count++] = mesh.tets(k, tet);
  const Vec3 a = mesh.nodes.col(top[0]), b = mesh.nodes.col(top[1]), c = mesh.nodes.col(top[2]);
  const double la = (b - c).norm(), lb = (c - a).norm(), lc = (a - b).norm();
  // Over the incentre the three angles are equal.
  const double inradius = (b - a).cross(c - a).norm() / (la + lb + lc);
  const Vec3 incentre = (la * a + lb * b + lc * c) / (la + lb + lc);
  append_node(mesh, incentre + Vec3::UnitZ() * inradius * std::tan(0.1 * M_PI / 180.0));
  append_tet(mesh, top[0], top[1], top[2], static_cast<int>(mesh.nodes.cols()) - 1);
  return mesh;
}

TetMesh mesh_with_tiny_element() {
  TetMesh mesh = mesh::box(Vec3::Constant(1.0), {1, 1, 1});
  int corner = 0;
  const int tet = only_tet_at(mesh, corner);
  int far[3], near[3], count = 0;
  for (int k = 0; k < 4; ++k)
    if (mesh.tets(k, tet) != corner) far[count++] = mesh.tets(k, tet);
  for (int k = 0; k < 3; ++k) {
    near[k] = static_cast<int>(mesh.nodes.cols());
    append_node(mesh, mesh.nodes.col(corner) + 0.01 * (mesh.nodes.col(far[k]) - mesh.nodes.col(corner)));
  }
  for (int t = tet; t + 1 < mesh.tets.cols(); ++t) mesh.tets.col(t) = mesh.tets.col(t + 1).eval();
  mesh.tets.conservativeResize(4, mesh.tets.cols() - 1);
  append_tet(mesh, corner, near[0], near[1], near[2]);
  append_tet(mesh, near[0], near[1], near[2], far[2]);
  append_tet(mesh, near[0], near[1], far[1], far[2]);
  append_tet(mesh, near[0], far[0], far[1], far[2]);
  return mesh;
}

Row sliver_row() {
  const auto problem_of = [](TetMesh (*make)()) {
    return [make] {
      fem::Material material;
      material.youngs_modulus = 1e5;
      return LinearProblem(make(), material, kDampingRatio, -0.4);
    };
  };
  return {"slivers",
          "degenerate elements in the same block, H = 10 ms.  Detects solves that lose the soft modes",
          RowColumns::kSteppers,
          false,
          {linear_case("dihedral 0.1 degree", problem_of(mesh_with_flat_element), kH),
           linear_case("volume ratio 1e6", problem_of(mesh_with_tiny_element), kH)}};
}

}  // namespace palpate::stability
