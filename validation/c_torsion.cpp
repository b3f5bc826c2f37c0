#include <cmath>

#include "cases.h"
#include "faults.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Problem: a square bar a x a between two ends that are rotated relative to each other by a small theta, in
// their plane and free along the axis.
//
// Exact answer: Saint-Venant torsion in the whole bar, for any length, since the ends do not hinder warping.
// Torque G J theta/L with (Timoshenko and Goodier, Theory of Elasticity, 109)
//
//   J = a^4 (1/3 - (64/pi^5) sum_{n odd} tanh(n pi/2)/n^5) = 0.140577 a^4.
//
// Measured: the torque, as the moment of the forces that hold one end. Limits: 5 % with 16 elements across, 1
// % after extrapolation with order 2, and the order from 1.8 to 2.2.

namespace palpate::validation {
namespace {

constexpr double kSide = 0.1, kLength = 0.05, kAngle = 1e-6, kYoung = 1e6, kPoisson = 0.3;

double torsion_constant() {
  double sum = 0.0;
  for (int n = 1; n < 200; n += 2) sum += std::tanh(0.5 * n * M_PI) / std::pow(n, 5);
  return std::pow(kSide, 4) * (1.0 / 3.0 - 64.0 / std::pow(M_PI, 5) * sum);
}

double torque(int across, const std::string& fault) {
  fem::Material m;
  m.youngs_modulus = kYoung;
  m.poissons_ratio = kPoisson;
  StaticBody body(mesh::box(Vec3(kSide, kSide, kLength), {across, across, across / 2}), m);
  if (fault == "half-stiffness") body.replace([](const auto& term) { return scaled(term, {.force = 0.5}); });
  if (fault == "no-lateral-strain") {
    fem::Material other = m;
    other.poissons_ratio = 0.0;  // E is kept, so that G changes.
    body.replace([&](const auto&) {
      return std::make_shared<fem::SoftBody>("body", body.rest(), other, fem::SoftBodyOptions{}, 0);
    });
  }
  const Points& X = body.rest().nodes;
  bool axis_held = false;
  for (int i = 0; i < X.cols(); ++i) {
    const bool end = std::abs(std::abs(X(2, i)) - 0.5 * kLength) < 1e-9;
    if (end) {
      const double angle = X(2, i) > 0.0 ? 0.5 * kAngle : -0.5 * kAngle;
      body.hold(i, 0, X(0, i) - angle * X(1, i));
      body.hold(i, 1, X(1, i) + angle * X(0, i));
    }
    // No warping on the axis: one node there prevents a drift along the axis.
    if (!axis_held && X.col(i).head<2>().norm() < 1e-9) {
      body.hold(i, 2, X(2, i));
      axis_held = true;
    }
  }
  if (!axis_held || !body.solve()) return std::nan("");
  const Points f = body.internal_forces();
  double moment = 0.0;
  for (int i = 0; i < X.cols(); ++i)
    if (X(2, i) > 0.5 * kLength - 1e-9) moment -= X(0, i) * f(1, i) - X(1, i) * f(0, i);
  return moment;
}

std::vector<Measurement> run(const std::string& fault) {
  const double exact = 0.5 * kYoung / (1.0 + kPoisson) * torsion_constant() * kAngle / kLength;
  std::vector<double> h, error, found;
  for (int across : {4, 8, 16}) {
    h.push_back(kSide / across);
    found.push_back(torque(across, fault));
    error.push_back(std::abs(found.back() / exact - 1.0));
  }
  const double extrapolated = found[2] + (found[2] - found[1]) / 3.0;  // Error of order 2 removed.
  return {{.quantity = "J / a^4",
           .computed = torsion_constant() / std::pow(kSide, 4),
           .exact = 0.140577,
           .error = std::abs(torsion_constant() / std::pow(kSide, 4) / 0.140577 - 1.0),
           .bar = 1e-5,
           .note = "the series against the tabled value"},
          {.quantity = "torque [N m], 16 elements across",
           .computed = found[2],
           .exact = exact,
           .error = error[2],
           .bar = 0.05,
           .order = validation::fitted_order(h, error),
           .order_low = 1.8,
           .order_high = 2.2,
           .note = "4, 8, 16 elements across",
           .refinement = {"element size [m]", h, error}},
          {.quantity = "torque [N m], extrapolated",
           .computed = extrapolated,
           .exact = exact,
           .error = std::abs(extrapolated / exact - 1.0),
           .bar = 0.01,
           .note = "from 8 and 16, order 2"}};
}

}  // namespace

ValidationCase torsion() {
  return {.name = "torsion",
          .section = "C",
          .summary = "square bar in torsion, ends free to warp: torque against Saint-Venant's",
          .why =
              "shear stress that varies over the section, and warping; Timoshenko and Goodier, Theory of "
              "Elasticity",
          .quick = true,
          .run = run,
          .faults = {{"half-stiffness", "torque"}, {"no-lateral-strain", "torque"}}};
}

}  // namespace palpate::validation
