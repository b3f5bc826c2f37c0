#include <cmath>

#include "cases.h"
#include "modal_body.h"
#include "palpate/mesh/generators.h"

// Problem: vibration of a free block a x a x b in Lame's mode.
//
// Exact answer (Lame 1852; Mindlin 1956): the field
//     u = cos(pi x/a) sin(pi y/a),   v = -sin(pi x/a) cos(pi y/a),   w = 0      (x, y in [0, a])
// has no divergence, so lambda does not enter: rho u_tt = mu laplace u gives w^2 = 2 mu (pi/a)^2/rho. Its
// stresses s_xx = -s_yy = -2 mu (pi/a) sin sin vanish on all four sides, and so do s_xy = mu (u_y + v_x) = 0
// everywhere and all stresses on z = 0, b: it is a mode of the free block,
//     omega = sqrt(2) pi sqrt(mu/rho)/a,
// for any Poisson's ratio and thickness. b differs from a, so that no mode in another plane has this
// frequency and mixes with it.
//
// Measured: the frequency, limit 5e-3 with order 1.8 to 2.1, and the overlap (mass-weighted; modal assurance
// criterion, Allemang and Brown 1982) by which the mode is identified, > 0.95.

namespace palpate::validation {
namespace {

constexpr double kSide = 0.1, kThickness = 0.04, kYoung = 5e4;
constexpr int kSought = 30;  // Number of modes, including six rigid ones.

Match lame(double poisson, int cells, const std::string& fault) {
  ModalBody block;
  block.material.youngs_modulus = kYoung;
  block.material.poissons_ratio = poisson;
  if (fault == "double-mass") block.defect.mass = 2.0;
  if (fault == "other-poisson") {
    block.defect.elements = block.materials();
    block.defect.elements->list[0].poissons_ratio -= 0.05;
  }
  block.rest = mesh::box(Vec3(kSide, kSide, kThickness), {cells, cells, cells * 2 / 5});
  if (fault == "holds-a-free-side")
    for (int i = 0; i < block.rest.nodes.cols(); ++i)
      if (block.rest.nodes(0, i) < -0.5 * kSide + 1e-9) block.defect.held.push_back(3 * i);
  const modes::Modes modes = block.lowest(kSought);
  return best_match(block, modes, block.field([](const Vec3& X) {
    const double x = M_PI * (X.x() / kSide + 0.5), y = M_PI * (X.y() / kSide + 0.5);
    return Vec3(std::cos(x) * std::sin(y), -std::sin(x) * std::cos(y), 0.0);
  }));
}

void add(double poisson, const std::string& fault, std::vector<Measurement>& out) {
  fem::Material m;
  m.youngs_modulus = kYoung;
  m.poissons_ratio = poisson;
  const double exact = std::sqrt(2.0 * m.mu() / m.density) / (2.0 * kSide);
  std::vector<double> h, error;
  double overlap = 1.0, frequency = 0.0;
  for (int cells : {15, 20, 25}) {
    if (!fault.empty() && cells == 25) break;  // A fault is detected without it.
    const Match match = lame(poisson, cells, fault);
    frequency = match.omega / (2.0 * M_PI);
    h.push_back(kSide / cells);
    error.push_back(std::abs(frequency / exact - 1.0));
    overlap = std::min(overlap, match.overlap);
  }
  out.push_back({.quantity = fmt::format("frequency [Hz], nu = {}, 25 cells per side", poisson),
                 .computed = frequency,
                 .exact = exact,
                 .error = error.back(),
                 .bar = 5e-3,
                 .order = validation::fitted_order(h, error),
                 .order_low = 1.8,
                 .order_high = 2.1,
                 .note = "15, 20, 25 cells per side",
                 .refinement = {"element size [m]", h, error}});
  out.push_back({.quantity = fmt::format("1 - overlap with Lame's mode, nu = {}", poisson),
                 .computed = 1.0 - overlap,
                 .error = 1.0 - overlap,
                 .bar = 0.05,
                 .note = "the worst of three meshes"});
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  add(0.3, fault, out);
  if (fault.empty()) add(0.45, fault, out);
  return out;
}

}  // namespace

ValidationCase lame_mode() {
  return {.name = "lame-mode",
          .section = "D",
          .summary =
              "a free block vibrates in Lame's mode, found by its overlap: frequency and order in the "
              "element size",
          .why =
              "the only mode of a three-dimensional free body in closed form; it depends only on G, so a "
              "wrong lambda is detected; rigid motions must not disturb it",
          .run = run,
          .faults = {{"double-mass", "frequency"},
                     {"other-poisson", "frequency"},
                     {"holds-a-free-side", "1 - overlap"}}};
}

}  // namespace palpate::validation
