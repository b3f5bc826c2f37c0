#include <cmath>

#include "cases.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Uniaxial stretch l, sides free: R = I, S = diag(l, s, s); no lateral stress 2 mu (s - 1) + lambda (l + 2 s
// - 3) = 0 gives
//   s = 1 - nu (l - 1),   P = 2 mu (l - 1) + lambda (l + 2 s - 3) = E (l - 1)
// (nominal stress; linear in l for this energy, at any l > 0).
//
// Simple shear F = I + g e1 e2^T: R turns by the angle with cos = 2/r, sin = g/r, r = sqrt(4 + g^2), and tr S
// = r + 1.  With s = g/r
//   P12 = 2 mu (g - s) + lambda (r - 2) s,   P21 = 2 mu s - lambda (r - 2) s,   P11 = P22 = 2 mu (1 - 2/r) +
//   lambda (r - 2) 2/r,
//   P33 = lambda (r - 2).

namespace palpate::validation {
namespace {

constexpr double kBar = 1e-10, kTiny = 1e-9;

fem::Material material_for(const std::string& sabotage) {
  fem::Material m;
  m.youngs_modulus = sabotage == "half-stiffness" ? 5e3 : 1e4;
  m.poissons_ratio = sabotage == "no-lateral-coupling" ? 0.0 : 0.3;
  return m;
}

const TetMesh& block() {
  static const TetMesh mesh = mesh::perturbed(mesh::box(Vec3(1.0, 0.6, 0.8), {4, 3, 3}), 0.2, 17);
  return mesh;
}

void stretch(double l, const std::string& sabotage, std::vector<Measurement>& out) {
  const fem::Material true_material = material_for("");
  StaticBody body(block(), material_for(sabotage));
  // Ends held along x, the block's rigid motion by three planes through a corner; the sides are free.
  const Vec3 low = body.rest().nodes.rowwise().minCoeff(), high = body.rest().nodes.rowwise().maxCoeff();
  for (int i = 0; i < body.rest().nodes.cols(); ++i) {
    Vec3 X = body.rest().nodes.col(i);
    const Vec3 x(low.x() + l * (X.x() - low.x()), X.y(), X.z());
    body.place(i, x);
    if (X.x() < low.x() + kTiny || X.x() > high.x() - kTiny) body.hold(i, 0, x.x());
    for (int axis : {1, 2})
      if (X[axis] < low[axis] + kTiny) body.hold(i, axis, X[axis]);
  }
  const bool solved = body.solve();
  const double nan = std::nan("");
  double top = 0.0;
  int counted = 0;
  for (int i = 0; i < body.rest().nodes.cols(); ++i)
    if (body.rest().nodes(1, i) > high.y() - kTiny) {
      top += body.position(i).y();
      ++counted;
    }
  const double lateral = (top / counted - low.y()) / (high.y() - low.y());
  const double exact_lateral = 1.0 - true_material.poissons_ratio * (l - 1.0),
               exact_stress = true_material.youngs_modulus * (l - 1.0);
  const Mat3 P = body.mean_stress();
  const std::string name = fmt::format("stretch {}: ", l);
  out.push_back({.quantity = name + "nominal stress [Pa]",
                 .computed = P(0, 0),
                 .exact = exact_stress,
                 .error = solved ? std::abs(P(0, 0) / exact_stress - 1.0) : nan,
                 .bar = kBar});
  out.push_back({.quantity = name + "lateral stretch",
                 .computed = lateral,
                 .exact = exact_lateral,
                 .error = solved ? std::abs(lateral / exact_lateral - 1.0) : nan,
                 .bar = kBar});
}

void shear(double g, const std::string& sabotage, std::vector<Measurement>& out) {
  const fem::Material m = material_for("");
  StaticBody body(block(), material_for(sabotage));
  const std::vector<char> boundary = boundary_nodes(body.rest());
  for (int i = 0; i < body.rest().nodes.cols(); ++i) {
    const Vec3 X = body.rest().nodes.col(i), x(X.x() + g * X.y(), X.y(), X.z());
    if (boundary[static_cast<std::size_t>(i)])
      body.hold(i, x);
    else
      body.place(i, x + 0.01 * Vec3(std::sin(3.0 * i), std::cos(5.0 * i), std::sin(7.0 * i)));
  }
  const bool solved = body.solve();
  const double r = std::sqrt(4.0 + g * g), s = g / r, volumetric = m.lambda() * (r - 2.0);
  Mat3 exact = Mat3::Zero();
  exact(0, 1) = 2.0 * m.mu() * (g - s) + volumetric * s;
  exact(1, 0) = 2.0 * m.mu() * s - volumetric * s;
  exact(0, 0) = exact(1, 1) = 2.0 * m.mu() * (1.0 - 2.0 / r) + volumetric * 2.0 / r;
  exact(2, 2) = volumetric;
  const Mat3 P = body.mean_stress();
  const double nan = std::nan("");
  const std::string name = fmt::format("shear {}: ", g);
  out.push_back({.quantity = name + "P12 [Pa]",
                 .computed = P(0, 1),
                 .exact = exact(0, 1),
                 .error = solved ? std::abs(P(0, 1) / exact(0, 1) - 1.0) : nan,
                 .bar = kBar});
  out.push_back({.quantity = name + "norm of P, all entries compared [Pa]",
                 .computed = P.norm(),
                 .exact = exact.norm(),
                 .error = solved ? (P - exact).norm() / exact.norm() : nan,
                 .bar = kBar});
}

std::vector<Measurement> run(const std::string& sabotage) {
  std::vector<Measurement> out;
  for (double l : {0.7, 1.1, 1.5, 3.0}) stretch(l, sabotage, out);
  for (double g : {0.01, 0.5, 1.5}) shear(g, sabotage, out);
  return out;
}

}  // namespace

ValidationCase uniaxial_and_shear() {
  return {
      .name = "uniaxial-and-shear",
      .section = "C",
      .summary = "one block stretched with free sides, and sheared: nominal stress and lateral contraction",
      .why =
          "the constitutive law itself at large strain, in closed form for this energy (derivation in the "
          "file)",
      .run = run,
      .sabotages = {"half-stiffness", "no-lateral-coupling"}};
}

}  // namespace palpate::validation
