#include <cmath>

#include "cases.h"
#include "core/polar.h"
#include "faults.h"
#include "palpate/core/error.h"
#include "palpate/core/pose.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Problem (patch test, Irons 1966): boundary nodes are set to x = A X + t, interior nodes are free.
//
// Exact answer: a linear tetrahedron represents every affine field, so the field is reproduced inside, with
// the stress P(A) everywhere, on any mesh: exact, without an order. With A = R S (docs/theory/elasticity.md)
//     P = 2 mu (A - R) + lambda tr(S - I) R.
// Measured: largest error of a node and the mean stress, limit 1e-10 (rounding and Newton's tolerance).

namespace palpate::validation {
namespace {

struct Field {
  const char* name;
  Mat3 A;
};

std::vector<Field> fields() {
  std::vector<Field> out;
  const char* names[] = {"strain xx", "strain yy", "strain zz", "strain yz", "strain xz", "strain xy"};
  const int rows[] = {0, 1, 2, 1, 0, 0}, columns[] = {0, 1, 2, 2, 2, 1};
  for (int i = 0; i < 6; ++i) {
    Mat3 A = Mat3::Identity();
    A(rows[i], columns[i]) += 0.05;
    if (rows[i] != columns[i]) A(columns[i], rows[i]) += 0.05;
    out.push_back({names[i], A});
  }
  Mat3 S;
  S << 1.3, 0.1, 0.05, 0.1, 0.9, -0.08, 0.05, -0.08, 1.1;
  out.push_back({"large strain, rotated by 2 rad",
                 quaternion_of(2.0 * Vec3(1, -2, 0.5).normalized()).toRotationMatrix() * S});
  return out;
}

/// Returns an element none of whose nodes is on the boundary.
Eigen::Vector4i inner_element(const TetMesh& mesh, const std::vector<char>& boundary) {
  for (const auto& tet : mesh.tets.colwise()) {
    bool inner = true;
    for (int node : tet) inner = inner && !boundary[static_cast<std::size_t>(node)];
    if (inner) return tet;
  }
  fail("the mesh has no inner element");
}

std::vector<Measurement> run(const std::string& fault) {
  fem::Material material;
  material.youngs_modulus = 2e4;
  material.poissons_ratio = 0.3;
  const TetMesh rest = mesh::perturbed(mesh::box(Vec3(1.0, 0.8, 1.2), {4, 4, 4}), 0.2, 7);
  const std::vector<char> boundary = boundary_nodes(rest);
  const Vec3 t(0.3, -0.1, 0.2);
  std::vector<Measurement> out;
  for (const Field& field : fields()) {
    StaticBody body(rest, material);
    if (fault == "one-element-counted-twice")
      body.add([&](int id) {
        const TetMesh one{rest.nodes, inner_element(rest, boundary)};
        return std::make_shared<fem::SoftBody>("again", one, material, fem::SoftBodyOptions{}, id);
      });
    if (fault == "half-stiffness")
      body.replace([](const auto& term) { return scaled(term, {.force = 0.5}); });
    double size = 0.0;
    for (int i = 0; i < rest.nodes.cols(); ++i) {
      const Vec3 X = rest.nodes.col(i), x = field.A * X + t;
      size = std::max(size, ((field.A - Mat3::Identity()) * X).norm());
      if (boundary[static_cast<std::size_t>(i)])
        body.hold(i, x);
      else
        // Displaced from the solution, so that Newton's method has to iterate.
        body.place(i, x + 0.01 * Vec3(std::sin(3.0 * i), std::cos(5.0 * i), std::sin(7.0 * i)));
    }
    const bool solved = body.solve();
    double error = solved ? 0.0 : std::nan("");
    for (int i = 0; i < rest.nodes.cols(); ++i)
      error = std::max(error, (body.position(i) - field.A * rest.nodes.col(i) - t).norm() / size);
    out.push_back({.quantity = std::string(field.name) + ": largest error of a node / largest displacement",
                   .computed = error,
                   .exact = 0.0,
                   .error = solved ? error : std::nan(""),
                   .bar = 1e-10});
    const Mat3 R = polar_decomposition(field.A).R;
    const Mat3 P = 2.0 * material.mu() * (field.A - R) +
                   material.lambda() * ((R.transpose() * field.A).trace() - 3.0) * R;
    const Mat3 mean = body.mean_stress();
    out.push_back({.quantity = std::string(field.name) + ": norm of the mean stress [Pa]",
                   .computed = mean.norm(),
                   .exact = P.norm(),
                   .error = (mean - P).norm() / P.norm(),
                   .bar = 1e-10});
  }
  return out;
}

}  // namespace

ValidationCase patch_test() {
  return {.name = "patch-test",
          .section = "C",
          .summary = "any uniform strain is reproduced inside an irregular mesh, and with it its stress",
          .why =
              "an element that fails this test does not converge on irregular meshes (Irons 1966); exact by "
              "theory, on any mesh",
          .quick = true,
          .run = run,
          .faults = {{"one-element-counted-twice", "largest error of a node"},
                     {"half-stiffness", "mean stress"}}};
}

}  // namespace palpate::validation
