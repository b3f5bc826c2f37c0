#include <cmath>

#include "cases.h"
#include "modal_body.h"
#include "palpate/mesh/generators.h"

// Problem: axial vibration of a bar held at x = 0 and free at x = L, with material 1 up to x = a and material
// 2 beyond it (b = L - a), nu = 0.
//
// Exact answer (one-dimensional waves), k_i = w/c_i,
//     u = sin(k_1 x)  for x < a,     u = B cos(k_2 (L - x))  beyond.
// At the border u and the force E u' are continuous:
//     sin(k_1 a) = B cos(k_2 b),   E_1 k_1 cos(k_1 a) = E_2 k_2 B sin(k_2 b),   hence
//     E_1 k_1 cos(k_1 a) cos(k_2 b) - E_2 k_2 sin(k_1 a) sin(k_2 b) = 0,
// whose roots w are the frequencies, found by bisection between changes of sign on a fine grid. With equal E
// and rho this is cos(w L/c) = 0.
//
// Measured: the first three frequencies, limit 5e-3, and their order. The border is between elements and the
// mode is smooth on either side, so linear elements keep their order 2 (accepted: 1.8 to 2.1).

namespace palpate::validation {
namespace {

constexpr double kLength = 1.0, kHalfWidth = 0.125, kBorder = 0.375;
constexpr int kModes = 3;

struct Layer {
  double youngs_modulus, density;
  double speed() const { return std::sqrt(youngs_modulus / density); }
};
constexpr Layer kFirst{1e6, 800.0}, kSecond{8e6, 2000.0};

double frequency_equation(double w) {
  const double k1 = w / kFirst.speed(), k2 = w / kSecond.speed(), a = kBorder, b = kLength - kBorder;
  return kFirst.youngs_modulus * k1 * std::cos(k1 * a) * std::cos(k2 * b) -
         kSecond.youngs_modulus * k2 * std::sin(k1 * a) * std::sin(k2 * b);
}

/// Returns the first roots [rad/s].
std::vector<double> exact_omegas() {
  std::vector<double> out;
  const double step = 0.01 * kFirst.speed() / kLength;
  for (double low = step; static_cast<int>(out.size()) < kModes; low += step) {
    double left = low, right = low + step;
    if (frequency_equation(left) * frequency_equation(right) > 0.0) continue;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (left + right);
      (frequency_equation(left) * frequency_equation(middle) > 0.0 ? left : right) = middle;
    }
    out.push_back(0.5 * (left + right));
  }
  return out;
}

/// Returns the frequencies [rad/s] of the axial modes; NaN if no mode overlaps by more than 0.95.
std::vector<double> found_omegas(int cells_along, bool consistent, const std::string& fault) {
  ModalBody bar;
  bar.rest =
      mesh::box(Vec3(kLength, kHalfWidth, kHalfWidth), {cells_along, cells_along / 8, cells_along / 8});
  const Vec3 corner = bar.rest.nodes.rowwise().minCoeff();
  bar.rest.nodes.colwise() -= corner;
  fem::Material first, second;
  first.poissons_ratio = second.poissons_ratio = 0.0;
  first.youngs_modulus = kFirst.youngs_modulus;
  second.youngs_modulus = kSecond.youngs_modulus;
  first.density = kFirst.density;
  second.density = kSecond.density;
  bar.layers = fem::Materials({first, second}, {});
  for (const auto& tet : bar.rest.tets.colwise())
    bar.layers->of_element.push_back(bar.rest.nodes(0, tet).mean() > kBorder);
  if (fault == "one-stiffness") {
    bar.defect.elements = bar.layers;
    bar.defect.elements->list[1].youngs_modulus = kFirst.youngs_modulus;
  }
  if (fault == "one-density") {
    bar.defect.masses = bar.layers;
    bar.defect.masses->list[1].density = kFirst.density;
  }
  bar.consistent_mass = consistent;
  bar.hold("xyz", [](const Vec3& X) { return X.x() < 1e-9; });
  // A quarter of the section, for the reason given in axial-vibration.
  bar.hold("y", [](const Vec3& X) { return X.y() < 1e-9; });
  bar.hold("z", [](const Vec3& X) { return X.z() < 1e-9; });
  const modes::Modes modes = bar.lowest(6);
  std::vector<double> out;
  for (const double w : exact_omegas()) {
    const double k1 = w / kFirst.speed(), k2 = w / kSecond.speed(),
                 B = std::sin(k1 * kBorder) / std::cos(k2 * (kLength - kBorder));
    const Match match = best_match(bar, modes, bar.field([&](const Vec3& X) {
      return Vec3(X.x() < kBorder ? std::sin(k1 * X.x()) : B * std::cos(k2 * (kLength - X.x())), 0.0, 0.0);
    }));
    out.push_back(match.overlap > 0.95 ? match.omega : std::nan(""));
  }
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  const std::vector<int> cells = {16, 24, 32, 48};  // The border is between cells.
  const std::vector<double> exact = exact_omegas();
  std::vector<Measurement> out;
  for (const bool consistent : {false, true}) {
    std::vector<double> h;
    std::vector<std::vector<double>> found;
    for (int n : cells) {
      h.push_back(kLength / n);
      found.push_back(found_omegas(n, consistent, fault));
    }
    for (std::size_t n = 0; n < exact.size(); ++n) {
      std::vector<double> error;
      for (const auto& one : found) error.push_back(std::abs(one[n] / exact[n] - 1.0));
      out.push_back({.quantity = fmt::format("frequency {} [rad/s], {} mass, {} cells along", n + 1,
                                             consistent ? "consistent" : "lumped", cells.back()),
                     .computed = found.back()[n],
                     .exact = exact[n],
                     .error = error.back(),
                     .bar = 5e-3,
                     .order = validation::fitted_order(h, error),
                     .order_low = 1.8,
                     .order_high = 2.1,
                     .note = "16, 24, 32, 48 cells along",
                     .refinement = {"element size [m]", h, error}});
    }
  }
  return out;
}

}  // namespace

ValidationCase two_material_bar() {
  return {.name = "two-material-bar",
          .section = "D",
          .summary =
              "a bar of two materials vibrates along its axis: first three frequencies against the roots of "
              "its frequency equation, order in the element size",
          .why =
              "stiffness and mass of both materials, and the transmission between them, against "
              "one-dimensional waves, whose solution is exact for nu = 0",
          .quick = true,
          .run = run,
          .faults = {{"one-stiffness", "frequency"}, {"one-density", "frequency"}}};
}

}  // namespace palpate::validation
