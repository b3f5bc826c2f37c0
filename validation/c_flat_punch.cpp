#include <Eigen/Cholesky>
#include <cmath>

#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "pressed_block.h"

// Problem: a rigid, frictionless punch with a flat round end (radius a) is pressed by d into an elastic
// half-space, E* = E/(1 - nu^2).
//
// Exact answer without springs (Sneddon 1965; Johnson 1985, 3.8):
//     F = 2 a E* d,     p(r) = F/(2 pi a^2 sqrt(1 - r^2/a^2)).
//
// Exact answer with springs. Contact here is a layer of springs, k per area, under the punch: with p/k in
// series the depth is
//     u(r) + p(r)/k = d,  r < a,        u = half-space under p,
// governed by one number, kappa = k a/E*. In the radial polynomials of Zernike, p = (E* d/a) sum c_n
// R_2n(r/a), whose Hankel transforms are (-1)^n J_(2n+1)(s)/s, and with u^(s) = 2 p^(s)/(E* s),
//     sum_n [ 8/(pi (1 - 4 (m-n)^2) (2(m+n) + 1) (2(m+n) + 3)) + delta_mn/(2 kappa (2m + 1)) ] c_n
//         = delta_m0/2,          F = pi a E* d c_0
// (the integral of J_(2m+1) J_(2n+1)/s^2 is due to Weber and Schafheitlin). kappa -> infinity is the punch,
// kappa -> 0 rigid bodies, F = k pi a^2 d. At kappa = 1000 the springs take 0.2 % of the depth, and neither k
// nor the area of each sample affects the force; at kappa = 1 they take half, and both do.
//
// Blocks. Rim and sides are both lines of one graded mesh: L/a = sinh(N ln 2)/sinh(ln 2) = 10.6, 21.3 and
// 42.7 for N = 4, 5, 6, each twice the previous one, as close to 10, 20 and 40 as possible. Extrapolation
// uses the actual a/L.
//
// Measured: the extrapolated force, limit 3 %, and the order of the error in the cell size. The rim is a
// line of the mesh, so that the elements' error is the error of the best approximation, and the error of the
// force is that of the energy: F_h - F ~ |u - u_h|^2.
//     kappa = 1000, springs shorter (a/kappa) than a cell: u ~ sqrt(r - a) beyond the rim, the cells around
//         it contain a fraction h of the energy: order 1 for elements of any order (accepted: 0.8 to 1.2).
//     kappa = 1: the pressure is bounded and jumps to 0 at the rim, u ~ (r - a) log|r - a|: h^2 log^2 h,
//         which over a factor of two in h appears as order 1.5 to 2 (accepted: 1.3 to 1.8).

namespace palpate::validation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kYoung = 1e4, kPoisson = 0.3;
const double kReduced = kYoung / (1.0 - kPoisson * kPoisson);
constexpr double kRadius = 0.5e-3, kDepth = 2e-4 * kRadius;  // a, d [m]
constexpr double kStiff = 1000.0, kSoft = 1.0;               // kappa
constexpr int kNear = 4;                                     // Doublings: L = 11 a.

/// Returns F/(2 a E* d) from the series.
double of_series(double kappa) {
  constexpr int kTerms = 300;
  Eigen::MatrixXd A(kTerms, kTerms);
  for (int m = 0; m < kTerms; ++m)
    for (int n = 0; n < kTerms; ++n)
      A(m, n) =
          8.0 / (kPi * (1.0 - 4.0 * (m - n) * (m - n)) * (2.0 * (m + n) + 1.0) * (2.0 * (m + n) + 3.0)) +
          (m == n ? 0.5 / (kappa * (2.0 * m + 1.0)) : 0.0);
  VecX right = VecX::Zero(kTerms);
  right[0] = 0.5;
  return 0.5 * kPi * A.ldlt().solve(right)[0];
}

double theory(double kappa) { return 2.0 * kRadius * kReduced * kDepth * of_series(kappa); }

/// Returns a block with m cells across the punch, from its centre to the rim.
BlockMesh block(int m, int doublings) {
  return {kRadius / std::sinh(std::log(2.0)), m, doublings, BlockShape::kRoundQuarter};
}

/// Contact by the cylinder's exact gaps at the block's vertices, or by its material points.
enum class Way { kVertices, kPoints };
std::string name_of(Way way) { return way == Way::kPoints ? "material points" : "vertices"; }

double force(Way way, double kappa, const BlockMesh& mesh, const std::string& fault) {
  // The radius is enlarged so that the vertices on the rim are nearer to the cylinder's end than to its side.
  constexpr double kBeyond = 2.0 * kDepth, kLength = 2.0 * kRadius, kCandidates = 0.01 * kRadius;
  fem::Material material;
  material.youngs_modulus = kYoung;
  material.poissons_ratio = kPoisson;
  const auto indenter = [&](contact::NodeSurface soft, int frame,
                            std::shared_ptr<contact::MovingFrame> motion) {
    contact::ContactSide side = soft;
    if (way == Way::kPoints) {
      const TetMesh rest = mesh.tets();
      side = contact::material_points(soft, mesh::boundary(rest).surface.vertices, rest,
                                      2.0 * mesh.half_width());
    }
    // Held: the tangent of samples that follow the state omits their motion, which would make Newton's steps
    // small.
    std::unique_ptr<contact::SampleSource> source = held(contact::make_cylinder_source(
        std::move(side), frame, std::move(motion), {Quat::Identity(), Vec3(0, 0, 0.5 * kLength - kDepth)},
        kRadius + kBeyond, kLength, kCandidates));
    if (fault == "rim-not-seen")
      return spoiled(std::move(source), [](auto& samples) {
        std::erase_if(samples, [](const auto& s) {
          return (s.b.offset + s.b.slide).template head<2>().norm() > 0.7 * kRadius;
        });
      });
    if (fault == "half-area")
      return spoiled(std::move(source), [](auto& samples) {
        for (auto& s : samples) s.area *= 0.5;
      });
    return source;
  };
  const double k = kappa * kReduced / kRadius;
  return indentation_force(mesh, material, k, indenter);
}

/// Measures the force on the half-space: cells are refined in the smallest block, then the sides of the block
/// are moved away, as in hertz-sphere.
Measurement measure(Way way, double kappa, const std::string& fault) {
  std::vector<double> h, by_size, far, by_block;
  for (const int m : {3, 4, 6}) {
    h.push_back(1.0 / m);
    by_size.push_back(force(way, kappa, block(m, kNear), fault));
  }
  for (const int doublings : {kNear, kNear + 1, kNear + 2}) {
    const BlockMesh mesh = block(2, doublings);
    far.push_back(kRadius / mesh.half_width());
    by_block.push_back(force(way, kappa, mesh, fault));
  }
  const double exact = theory(kappa),
               found = limit_of(h, by_size).value * at_zero(far, by_block) / by_block.front();
  std::string note = "at L = 11, 21, 43 a, 2 cells across the radius:";
  for (const double one : by_block) note += fmt::format(" {:+.1f} %", 100.0 * (one / exact - 1.0));
  return {.quantity = fmt::format("{}: force at k a/E* = {:g} [N]", name_of(way), kappa),
          .computed = found,
          .exact = exact,
          .error = std::abs(found / exact - 1.0),
          .bar = 3e-2,
          .note = note};
}

/// Measures the elements' error in a small block, 2.5 a: the error at the rim is the same in any block.
Measurement order_in_cells(Way way, double kappa, double low, double high) {
  std::vector<double> h, by_size, errors;
  for (const int m : {6, 8, 12}) {
    h.push_back(1.0 / m);
    by_size.push_back(force(way, kappa, block(m, 2), ""));
  }
  const Limit limit = limit_of(h, by_size);
  for (const double one : by_size) errors.push_back(std::abs(one / limit.value - 1.0));
  return {.quantity = fmt::format("{}: discretisation error of the force at k a/E* = {:g}, 12 cells across "
                                  "the radius",
                                  name_of(way), kappa),
          .computed = by_size.back(),
          .exact = limit.value,
          .error = errors.back(),
          .bar = 0.1,
          .order = limit.order,
          .order_low = low,
          .order_high = high,
          .note = "order over 6, 8, 12 cells",
          .refinement = {"cell / radius of the punch", h, errors}};
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  if (fault.empty()) {
    const double limit = of_series(1e5);
    out.push_back({.quantity = "series at k a/E* = 1e5: force/(2 a E* d)",
                   .computed = limit,
                   .exact = 1.0,
                   .error = std::abs(limit - 1.0),
                   .bar = 1e-3});
    out.push_back(measure(Way::kVertices, kStiff, fault));
  }
  for (const double kappa : {kStiff, kSoft}) out.push_back(measure(Way::kPoints, kappa, fault));
  if (!fault.empty()) return out;
  out.push_back(order_in_cells(Way::kPoints, kStiff, 0.8, 1.2));
  out.push_back(order_in_cells(Way::kPoints, kSoft, 1.3, 1.8));
  return out;
}

}  // namespace

ValidationCase flat_punch() {
  return {
      .name = "flat-punch",
      .section = "C",
      .summary = "force of a rigid flat-ended cylinder on a soft block, through stiff and soft springs",
      .why =
          "the contact area is given, so the force depends only on the compliance of the elements, whose "
          "order is limited by the singular pressure at the rim, and of the springs in series (Sneddon 1965)",
      .slow = true,
      .run = run,
      .faults = {{"rim-not-seen", "force at k a/E*"}, {"half-area", "k a/E* = 1 [N]"}},
      .about_s = 250,
  };
}

}  // namespace palpate::validation
