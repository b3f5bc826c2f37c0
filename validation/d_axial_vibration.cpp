#include <cmath>

#include "cases.h"
#include "modal_body.h"
#include "palpate/mesh/generators.h"

// Problem: axial vibration of a bar with length L held at x = 0, nu = 0.
//
// Exact answer (Rayleigh 1877): axial strain causes no lateral stress, so u(x, t) obeys u_tt = c^2 u_xx,
// c = sqrt(E/rho), exactly, and
//     u_n = sin((2n - 1) pi x / 2L),   f_n = (2n - 1) c / (4 L).
//
// Measured: the first three frequencies, limit 5e-3, and their order in the element size (1.8 to 2.1). Linear
// elements with lumped mass have w_h = w (1 - (k h)^2/24 ...) in one dimension, and order 2 in any. A
// quarter of the square section represents the bar: its two inner faces are planes of symmetry (no
// displacement across them), which keeps every axial motion and excludes bending and torsion, whose
// frequencies cross the axial ones. Modes are identified by their overlap with u_n.

namespace palpate::validation {
namespace {

constexpr double kLength = 1.0, kHalfWidth = 0.125, kYoung = 1e6;
constexpr int kModes = 3;

/// Returns the frequencies [Hz] of the first three axial modes; NaN if no mode overlaps by more than 0.95.
std::vector<double> frequencies(int cells_along, const std::string& fault) {
  ModalBody bar;
  bar.material.youngs_modulus = kYoung;
  bar.material.poissons_ratio = 0.0;
  if (fault == "half-stiffness") bar.defect.force = 0.5;
  if (fault == "double-mass") bar.defect.mass = 2.0;
  if (fault == "lateral-strain") {
    bar.defect.elements = bar.materials();
    bar.defect.elements->list[0].poissons_ratio = 0.4;
  }
  bar.rest =
      mesh::box(Vec3(kLength, kHalfWidth, kHalfWidth), {cells_along, cells_along / 8, cells_along / 8});
  const Vec3 corner = bar.rest.nodes.rowwise().minCoeff();
  bar.rest.nodes.colwise() -= corner;
  bar.hold("xyz", [&](const Vec3& X) { return X.x() < 1e-9; });
  bar.hold("y", [](const Vec3& X) { return X.y() < 1e-9; });
  bar.hold("z", [](const Vec3& X) { return X.z() < 1e-9; });
  const modes::Modes modes = bar.lowest(6);
  std::vector<double> out;
  for (int n = 1; n <= kModes; ++n) {
    const double k = (2 * n - 1) * M_PI / (2.0 * kLength);
    const Match match =
        best_match(bar, modes, bar.field([k](const Vec3& X) { return Vec3(std::sin(k * X.x()), 0.0, 0.0); }));
    out.push_back(match.overlap > 0.95 ? match.omega / (2.0 * M_PI) : std::nan(""));
  }
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  const std::vector<int> cells = {16, 24, 32, 48};
  std::vector<double> h;
  std::vector<std::vector<double>> found;
  for (int n : cells) {
    h.push_back(kLength / n);
    found.push_back(frequencies(n, fault));
  }
  const double c = std::sqrt(kYoung / fem::Material{}.density);
  std::vector<Measurement> out;
  for (int n = 1; n <= kModes; ++n) {
    const double exact = (2 * n - 1) * c / (4.0 * kLength);
    std::vector<double> error;
    for (const auto& one : found)
      error.push_back(std::abs(one[static_cast<std::size_t>(n - 1)] / exact - 1.0));
    out.push_back({.quantity = fmt::format("frequency {} [Hz], {} cells along", n, cells.back()),
                   .computed = found.back()[static_cast<std::size_t>(n - 1)],
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

ValidationCase axial_vibration() {
  return {
      .name = "axial-vibration",
      .section = "D",
      .summary =
          "a bar vibrates along its axis: first three frequencies against (2n - 1) c / 4L, order in the "
          "element size",
      .why =
          "stiffness and mass together against the wave equation, whose solution is exact for nu = 0 "
          "(Rayleigh 1877)",
      .quick = true,
      .run = run,
      .faults = {
          {"half-stiffness", "frequency"}, {"double-mass", "frequency"}, {"lateral-strain", "frequency"}}};
}

}  // namespace palpate::validation
