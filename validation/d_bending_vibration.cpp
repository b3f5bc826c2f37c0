#include <cmath>

#include "cases.h"
#include "modal_body.h"
#include "palpate/mesh/generators.h"

// Problem: first bending frequency of a slender cantilever, square section h x h, nu = 0.
//
// Exact answer: Euler-Bernoulli theory, cos(bL) cosh(bL) = -1, b1 L = 1.875104,
//     f1 = (b1 L)^2/(2 pi) sqrt(E I/(rho A L^4)),   I/A = h^2/12,
// times the factor of shear and rotary inertia (Timoshenko 1921, shear factor 5/6, G = E/2, solved for the
// first root): 0.99350 at L/h = 10 and 0.99836 at L/h = 20.
//
// Measured: order of the frequency, and its Richardson value with the limit 1e-2. A quarter of the section
// represents the beam that bends along y, as in the static case: u is symmetric in z (u_z = 0 on z = 0) and
// antisymmetric in y (u_x = u_z = 0 on y = 0). This excludes bending along z and torsion, so that the lowest
// mode is the one sought. Elements h/n: order 2 in 1/n; the error of linear tetrahedra in bending is about
// (h/n)^2 / (h^2/12).

namespace palpate::validation {
namespace {

constexpr double kHeight = 0.1, kYoung = 1e6;

double frequency(double slenderness, int across, const std::string& fault) {
  const double length = slenderness * kHeight;
  ModalBody beam;
  beam.material.youngs_modulus = kYoung;
  if (fault == "half-stiffness") beam.defect.force = 0.5;
  if (fault == "double-mass") beam.defect.mass = 2.0;
  beam.material.poissons_ratio = 0.0;
  beam.rest = mesh::box(Vec3(length, 0.5 * kHeight, 0.5 * kHeight),
                        {static_cast<int>(slenderness) * across, across / 2, across / 2});
  const Vec3 corner = beam.rest.nodes.rowwise().minCoeff();
  beam.rest.nodes.colwise() -= corner;
  beam.hold("xyz", [](const Vec3& X) { return X.x() < 1e-9; });
  beam.hold("xz", [](const Vec3& X) { return X.y() < 1e-9; });
  beam.hold("z", [&](const Vec3& X) { return X.z() < 1e-9; });
  return beam.lowest(1).frequency_hz(0);
}

void add(double slenderness, double timoshenko, const std::vector<int>& across, const std::string& fault,
         std::vector<Measurement>& out) {
  const double length = slenderness * kHeight, density = fem::Material{}.density;
  const double exact = timoshenko * std::pow(1.875104, 2) / (2.0 * M_PI) *
                       std::sqrt(kYoung * kHeight * kHeight / (12.0 * density * std::pow(length, 4)));
  std::vector<double> h, found, error;
  for (int n : across) {
    h.push_back(kHeight / n);
    found.push_back(frequency(slenderness, n, fault));
    error.push_back(std::abs(found.back() / exact - 1.0));
  }
  const std::size_t last = h.size() - 1;
  const double ratio = std::pow(h[last - 1] / h[last], 2);
  const double extrapolated = found[last] + (found[last] - found[last - 1]) / (ratio - 1.0);
  out.push_back({.quantity = fmt::format("first frequency [Hz], L/h = {}, {} elements across", slenderness,
                                         across.back()),
                 .computed = found.back(),
                 .exact = exact,
                 .error = error.back(),
                 .bar = 0.05,
                 .order = validation::fitted_order(h, error),
                 .order_low = 1.8,
                 .order_high = 2.2,
                 .note = fmt::format("{} elements across", fmt::join(across, ", ")),
                 .refinement = {"element size [m]", h, error}});
  out.push_back({.quantity = fmt::format("first frequency [Hz], L/h = {}, Richardson", slenderness),
                 .computed = extrapolated,
                 .exact = exact,
                 .error = std::abs(extrapolated / exact - 1.0),
                 .bar = 1e-2,
                 .note = "order 2 removed from the last two"});
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  add(10.0, 0.99350, {4, 6, 8}, fault, out);
  add(20.0, 0.99836, {4, 6, 8}, fault, out);
  return out;
}

}  // namespace

ValidationCase bending_vibration() {
  return {.name = "bending-vibration",
          .section = "D",
          .summary =
              "first frequency of a slender cantilever against Timoshenko's beam, L/h = 10 and 20, order and "
              "Richardson value",
          .why =
              "the lowest mode of most soft bodies is bending, and linear tetrahedra are stiff in it; "
              "Timoshenko 1921",
          .quick = true,
          .run = run,
          .faults = {{"half-stiffness", "first frequency"}, {"double-mass", "first frequency"}}};
}

}  // namespace palpate::validation
