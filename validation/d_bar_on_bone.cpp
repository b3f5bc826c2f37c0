#include <algorithm>
#include <cmath>

#include "cases.h"
#include "modal_body.h"
#include "palpate/mesh/generators.h"

// Problem: axial vibration of a bar with length L, section A, nu = 0, whose face x = 0 is attached to a free
// rigid bone with mass m_b and whose other end is free.
//
// Exact answer (Timoshenko, Vibration Problems in Engineering, 1937, section 52: a bar with a mass at its
// end): u_tt = c^2 u_xx, c = sqrt(E/rho), and
//     m_b u_tt(0) = E A u_x(0),   u_x(L) = 0.
// u = cos(k (L - x)) cos(c k t) gives
//     tan(kL) = -b kL,   b = m_b / (rho A L):
// one root in each ((n - 1/2) pi, n pi). With a massless bone the bar is free, kL = n pi; a heavy bone fixes
// it.
//
// Measured: the first frequency, limit 5e-3, with order 1.8 to 2.1 in the element size. The bone's equation
// contains only its inertia and the reaction of the face: if that reaction, or the inertia of the nodes on
// the face, did not reach it, the frequency would be wrong. A quarter of the square section represents the
// bar, as in the case without a bone: planes of symmetry exclude bending and torsion. The bone is at the
// centre of the quarter's face, so that axial motion does not rotate it.

namespace palpate::validation {
namespace {

constexpr double kLength = 1.0, kHalfWidth = 0.125, kYoung = 1e6;

/// Returns kL of the n-th vibration by bisection: sin(z) + b z cos(z) changes sign once in ((n - 1/2) pi, n
/// pi).
double root(double b, int n) {
  double low = (n - 0.5) * M_PI, high = n * M_PI;
  const auto f = [b](double z) { return std::sin(z) + b * z * std::cos(z); };
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (std::signbit(f(middle)) == std::signbit(f(low)) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Returns the frequency [Hz] of the first axial vibration; NaN if no mode overlaps by more than 0.95.
double frequency(int cells, double b, const std::string& fault) {
  ModalBody bar;
  bar.material.youngs_modulus = kYoung;
  if (fault == "half-stiffness") bar.defect.force = 0.5;
  if (fault == "light-bone") bar.defect.bone_mass = 0.5;
  bar.material.poissons_ratio = 0.0;
  bar.rest = mesh::box(Vec3(kLength, kHalfWidth, kHalfWidth), {cells, cells / 8, cells / 8});
  const Vec3 corner = bar.rest.nodes.rowwise().minCoeff();
  bar.rest.nodes.colwise() -= corner;
  const double mass = bar.material.density * kLength * kHalfWidth * kHalfWidth;
  for (int i = 0; i < bar.rest.nodes.cols(); ++i)
    if (bar.rest.nodes(0, i) < 1e-9) bar.carried.push_back(i);
  bar.bone_mass = b * mass;
  bar.bone_inertia.setConstant(bar.bone_mass * kHalfWidth * kHalfWidth / 6.0);
  bar.bone_centre = Vec3(0.0, 0.5 * kHalfWidth, 0.5 * kHalfWidth);
  bar.hold("y", [](const Vec3& X) { return X.y() < 1e-9 && X.x() > 1e-9; });
  bar.hold("z", [](const Vec3& X) { return X.z() < 1e-9 && X.x() > 1e-9; });
  const double k = root(b, 1) / kLength;
  const modes::Modes modes = bar.lowest(8);
  const Match match = best_match(
      bar, modes, bar.field([k](const Vec3& X) { return Vec3(std::cos(k * (kLength - X.x())), 0.0, 0.0); }));
  return match.overlap > 0.95 ? match.omega / (2.0 * M_PI) : std::nan("");
}

std::vector<Measurement> run(const std::string& fault) {
  const std::vector<int> cells = {16, 24, 32, 48};
  const double c = std::sqrt(kYoung / fem::Material{}.density);
  std::vector<Measurement> out;
  for (const double b : {1e-3, 0.3, 3.0}) {
    const double exact = root(b, 1) * c / (2.0 * M_PI * kLength);
    std::vector<double> h, error;
    double found = 0.0;
    for (int n : cells) {
      h.push_back(kLength / n);
      found = frequency(n, b, fault);
      error.push_back(std::abs(found / exact - 1.0));
    }
    out.push_back({.quantity = fmt::format("frequency [Hz], bone of {:g} of the bar's mass, {} cells along",
                                           b, cells.back()),
                   .computed = found,
                   .exact = exact,
                   .error = error.back(),
                   .bar = 5e-3,
                   .order = validation::fitted_order(h, error),
                   .order_low = 1.8,
                   .order_high = 2.1,
                   .note = "16, 24, 32, 48 cells along",
                   .refinement = {"element size [m]", h, error}});
  }
  return out;
}

}  // namespace

ValidationCase bar_on_bone() {
  return {.name = "bar-on-bone",
          .section = "D",
          .summary =
              "a bar vibrates along its axis against a free bone at its end: frequency against tan(kL) = "
              "-(m_b/m) kL, order in the element size",
          .why =
              "tissue and bone must exchange momentum at the correct rate, even if the bone has a thousandth "
              "of the mass of the tissue (Timoshenko 1937)",
          .quick = true,
          .run = run,
          .faults = {{"half-stiffness", "frequency"}, {"light-bone", "bone of 3 "}}};
}

}  // namespace palpate::validation
