#include <cmath>

#include "cases.h"
#include "experiments/compare/grid_convergence.h"
#include "faults.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Problem: slender cantilever with a square section h x h, L/h = 10, nu = 0, under a small end load P.
//
// Exact answer (Timoshenko 1921, shear factor of Cowper 1966): tip deflection
//   P L^3/(3 E I) + P L/(kappa G A),   I = h^4/12, A = h^2, G = E/2, kappa = 5/6.
// With the parabolic end traction tau(y) = 3P/(2A) (1 - (2y/h)^2) of beam theory, the work-conjugate
// deflection integral(tau u)/P equals twice the strain energy over P, and the energy of bending and of this
// shear stress gives exactly the two terms (Castigliano). Neglected is the hindered warping at the clamp, a
// few 1e-4.
//
// Measured: order of the deflection (1.8 to 2.2 accepted), 5 % with 16 elements across, and 5e-3 after
// Richardson extrapolation.
//
// With nu = 0 and a load along y, u is symmetric in z (u_z = 0 on z = 0) and antisymmetric in y (u_x = u_z =
// 0 on y = 0). A quarter of the section, with these supports and a quarter of P, represents the whole beam:
// 16 elements across the section are 8 x 8 here.

namespace palpate::validation {
namespace {

constexpr double kHeight = 0.1, kLength = 1.0, kLoad = 1e-3, kYoung = 1e6;

double traction(double y) {
  return 1.5 * kLoad / (kHeight * kHeight) * (1.0 - std::pow(2.0 * y / kHeight, 2));
}

/// Returns the deflection [m] conjugate to the load, with `across` elements over the whole height.
double deflection(int across, const std::string& fault) {
  fem::Material m;
  m.youngs_modulus = kYoung;
  m.poissons_ratio = 0.0;
  TetMesh rest =
      mesh::box(Vec3(kLength, 0.5 * kHeight, 0.5 * kHeight), {10 * across, across / 2, across / 2});
  const Vec3 corner = rest.nodes.rowwise().minCoeff();
  rest.nodes.colwise() -= corner;
  StaticBody body(rest, m);
  if (fault == "half-stiffness") body.replace([](const auto& term) { return scaled(term, {.force = 0.5}); });
  for (int i = 0; i < rest.nodes.cols(); ++i) {
    const Vec3 X = rest.nodes.col(i);
    if (X.x() < 1e-9) body.hold(i, X);
    if (X.y() < 1e-9) {
      body.hold(i, 0, X.x());
      body.hold(i, 2, X.z());
    }
    if (X.z() < 1e-9) body.hold(i, 2, X.z());
  }
  const VecX carried = end_loads(rest, kLength, traction);
  for (int i = 0; i < rest.nodes.cols(); ++i) body.load(i, Vec3(0, carried[i], 0));
  if (!body.solve()) return std::nan("");
  double work = 0.0;
  for (int i = 0; i < rest.nodes.cols(); ++i) work += carried[i] * body.displacement(i).y();
  return work / (0.25 * kLoad);
}

std::vector<Measurement> run(const std::string& fault) {
  const double inertia = std::pow(kHeight, 4) / 12.0, area = kHeight * kHeight, shear = 0.5 * kYoung;
  const double exact =
      kLoad * std::pow(kLength, 3) / (3.0 * kYoung * inertia) + kLoad * kLength / (5.0 / 6.0 * shear * area);
  std::vector<double> h, error, tip;
  for (int across : {8, 12, 16}) {
    tip.push_back(deflection(across, fault));
    h.push_back(kHeight / across);
    error.push_back(std::abs(tip.back() / exact - 1.0));
  }
  const compare::GridEstimate limit = compare::estimate(h, tip);
  const double ratio = std::pow(h[1] / h[2], 2);
  const double extrapolated = tip[2] + (tip[2] - tip[1]) / (ratio - 1.0);  // Error of order 2 removed.
  return {{.quantity = "tip deflection [m], 16 elements across",
           .computed = tip[2],
           .exact = exact,
           .error = error[2],
           .bar = 0.05,
           .order = validation::fitted_order(h, error),
           .order_low = 1.8,
           .order_high = 2.2,
           .note = "8, 12, 16 elements across",
           .refinement = {"element size [m]", h, error}},
          {.quantity = "tip deflection [m], Richardson",
           .computed = extrapolated,
           .exact = exact,
           .error = std::abs(extrapolated / exact - 1.0),
           .bar = 5e-3,
           .note = "from 12 and 16, order 2"},
          {.quantity = "tip deflection [m] of `compare --mesh` (error: in units of its uncertainty)",
           .computed = limit.value,
           .exact = exact,
           .error = std::abs(limit.value - exact) / limit.uncertainty,
           .bar = 1.0,
           .note = fmt::format("order {:.2f}, uncertainty {:.2g} %", limit.order,
                               100.0 * limit.uncertainty / limit.value)}};
}

}  // namespace

ValidationCase cantilever() {
  return {.name = "cantilever",
          .section = "C",
          .summary =
              "slender cantilever under a small end load against Timoshenko's deflection, order and "
              "Richardson value",
          .why =
              "linear tetrahedra are inaccurate in bending: shows how many elements the thickness requires; "
              "Timoshenko 1921, shear factor of Cowper 1966",
          .run = run,
          .faults = {{"half-stiffness", "tip deflection"}}};
}

}  // namespace palpate::validation
