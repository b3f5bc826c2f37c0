#include <cmath>

#include "cases.h"
#include "faults.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Problem: one block stretched with free sides, and sheared, at large strain. Measured: nominal stress and
// lateral stretch, limit 1e-10, as the uniform field is exact in linear elements.
//
// Exact answer, uniaxial stretch l, sides free: R = I, S = diag(l, s, s); zero lateral stress,
//     2 mu (s - 1) + lambda (l + 2 s - 3) = 0,
// gives
//     s = 1 - nu (l - 1),   P = 2 mu (l - 1) + lambda (l + 2 s - 3) = E (l - 1)
// (nominal stress; linear in l for this energy, at any l > 0).
//
// Exact answer, simple shear F = I + g e1 e2^T: R rotates by the angle with cos = 2/r, sin = g/r, r = sqrt(4
// + g^2), and tr S = r + 1. With s = g/r
//     P12 = 2 mu (g - s) + lambda (r - 2) s,
//     P21 = 2 mu s - lambda (r - 2) s,
//     P11 = P22 = 2 mu (1 - 2/r) + lambda (r - 2) 2/r,
//     P33 = lambda (r - 2).
//
// Exact answer, stable neo-Hookean (Smith, de Goes and Kim 2018, eq. 14), in the stretches of the same
// uniaxial state: with m = 4/3 mu, L = lambda + 5/6 mu, alpha = 1 + 3 m/(4 L), I = l^2 + 2 s^2, J = l s^2,
//     lateral stress  m s (1 - 1/(I + 1)) + L (J - alpha) l s = 0,
//     P = m l (1 - 1/(I + 1)) + L (J - alpha) s^2.
// The lateral stress over s grows with s, so that s is found by bisection.

namespace palpate::validation {
namespace {

constexpr double kBar = 1e-10, kTiny = 1e-9;

fem::Material material() {
  fem::Material m;
  m.youngs_modulus = 1e4;
  m.poissons_ratio = 0.3;
  return m;
}

const TetMesh& block() {
  static const TetMesh mesh = mesh::perturbed(mesh::box(Vec3(1.0, 0.6, 0.8), {4, 3, 3}), 0.2, 17);
  return mesh;
}

struct Uniaxial {
  double lateral, stress;
};

Uniaxial corotational(const fem::Material& m, double l) {
  return {1.0 - m.poissons_ratio * (l - 1.0), m.youngs_modulus * (l - 1.0)};
}

Uniaxial stable_neo_hookean(const fem::Material& material, double l) {
  const double m = 4.0 / 3.0 * material.mu(), L = material.lambda() + 5.0 / 6.0 * material.mu(),
               alpha = 1.0 + 0.75 * m / L;
  const auto share = [&](double s) { return m * (1.0 - 1.0 / (l * l + 2.0 * s * s + 1.0)); };
  double low = 0.0, high = 10.0;
  for (int i = 0; i < 200; ++i) {
    const double s = 0.5 * (low + high);
    (share(s) + L * (l * s * s - alpha) * l < 0.0 ? low : high) = s;
  }
  return {low, share(low) * l + L * (l * low * low - alpha) * low * low};
}

struct Law {
  const char* name;
  Uniaxial (*exact)(const fem::Material&, double);
};
constexpr Law kLaws[] = {{"corotational", corotational}, {"stable_neo_hookean", stable_neo_hookean}};

void break_body(StaticBody& body, fem::SoftBodyOptions options, const std::string& fault) {
  fem::Material m = material();
  if (fault == "half-stiffness") body.replace([](const auto& term) { return scaled(term, {.force = 0.5}); });
  if (fault == "small-strain")
    body.replace([&](const auto& term) { return small_strain(term, body.rest().nodes.reshaped()); });
  if (fault == "no-lateral-coupling") m.poissons_ratio = 0.0;
  if (fault == "other-law") options.law = kLaws[options.law == kLaws[0].name ? 1 : 0].name;
  if (fault == "no-lateral-coupling" || fault == "other-law")
    body.replace(
        [&](const auto&) { return std::make_shared<fem::SoftBody>("body", body.rest(), m, options, 0); });
}

void stretch(const Law& law, double l, const std::string& fault, std::vector<Measurement>& out) {
  fem::SoftBodyOptions options;
  options.law = law.name;
  StaticBody body(block(), material(), options);
  break_body(body, options, fault);
  // Fixes the ends along x and the rigid motion by three planes through a corner; the sides are free.
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
  const auto [exact_lateral, exact_stress] = law.exact(material(), l);
  const Mat3 P = body.mean_stress();
  const std::string name = fmt::format("{}, stretch {}: ", law.name, l);
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

void shear(double g, const std::string& fault, std::vector<Measurement>& out) {
  const fem::Material m = material();
  StaticBody body(block(), m);
  break_body(body, {}, fault);
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

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  for (const Law& law : kLaws)
    for (double l : {0.7, 1.1, 1.5, 3.0}) stretch(law, l, fault, out);
  for (double g : {0.01, 0.5, 1.5}) shear(g, fault, out);
  return out;
}

}  // namespace

ValidationCase uniaxial_and_shear() {
  return {
      .name = "uniaxial-and-shear",
      .section = "C",
      .summary = "one block stretched with free sides, and sheared: nominal stress and lateral contraction",
      .why =
          "the constitutive laws at large strain, in closed form for their energies (derivation in the file)",
      .run = run,
      .faults = {{"half-stiffness", "nominal stress"},
                 {"no-lateral-coupling", "lateral stretch"},
                 {"other-law", "nominal stress"},
                 {"small-strain", "shear 1.5"}}};
}

}  // namespace palpate::validation
