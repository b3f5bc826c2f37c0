#include <cmath>

#include "cases.h"
#include "faults.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Problem: slender cantilever under an end load P with fixed direction, large deflection.
//
// Exact answer (elastica, Bisshopp and Drucker 1945):
//     E I theta'' = -P cos(theta).
// With a = P L^2/(E I), the slope theta0 at the end, p^2 = (1 + sin theta0)/2 and sin phi = 1/(sqrt(2) p),
//     sqrt(a) = K(p) - F(phi, p),
//     drop/L = 1 - 2 (E(p) - E(phi, p))/sqrt(a),
//     1 - shortening/L = sqrt(2 sin(theta0)/a).
//
// Measured: drop and shortening, extrapolated from two meshes with order 2, limit 1 %. For nu = 0 and
// uniaxial strain psi = E (l - 1)^2/2, so that the moment is E I times the curvature at any strain. The
// elastica neglects shear and extension of the axis, both below 0.2 % at L/h = 20. Nothing depends on z (nu =
// 0): one layer of cells between two planes z = const represents the whole beam.

namespace palpate::validation {
namespace {

constexpr double kLength = 1.0, kHeight = 0.05, kYoung = 1e6;

struct Bend {
  double drop, shortening;
};

Bend elastica(double a) {
  const auto modulus = [](double theta0) { return std::sqrt(0.5 * (1.0 + std::sin(theta0))); };
  const auto phi = [](double p) { return std::asin(1.0 / (std::sqrt(2.0) * p)); };
  double low = 1e-9, high = 0.5 * M_PI - 1e-9;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high), p = modulus(middle);
    (std::comp_ellint_1(p) - std::ellint_1(p, phi(p)) < std::sqrt(a) ? low : high) = middle;
  }
  const double p = modulus(low);
  return {1.0 - 2.0 * (std::comp_ellint_2(p) - std::ellint_2(p, phi(p))) / std::sqrt(a),
          1.0 - std::sqrt(2.0 * std::sin(low) / a)};
}

struct Beam {
  StaticBody body;
  std::vector<std::pair<int, double>> end;  ///< Nodes of the end face with their fraction of it.
  double width;

  Beam(const TetMesh& rest, const fem::Material& m, double w) : body(rest, m), width(w) {
    for (int i = 0; i < rest.nodes.cols(); ++i) {
      const Vec3 X = rest.nodes.col(i);
      if (X.x() < 1e-9)
        body.hold(i, X);
      else
        body.hold(i, 2, X.z());
      if (X.x() > kLength - 1e-9) end.emplace_back(i, X.y() < 1e-9 || X.y() > kHeight - 1e-9 ? 0.5 : 1.0);
    }
    double sum = 0.0;
    for (const auto& [node, share] : end) sum += share;
    for (auto& [node, share] : end) share /= sum;
  }
  double force_of(double a) const {
    return a * kYoung * width * std::pow(kHeight, 3) / 12.0 / (kLength * kLength);
  }
  void load(const Vec3& force) {
    body.remove_loads();
    for (const auto& [node, share] : end) body.load(node, share * force);
  }
  Vec3 end_displacement() const {
    Vec3 sum = Vec3::Zero();
    for (const auto& [node, share] : end) sum += share * body.displacement(node);
    return sum;
  }
};

/// Returns drop and shortening, divided by L, under each load in succession; NaN where Newton's method fails.
std::vector<Bend> bend(int across, const std::vector<double>& loads, const std::string& fault) {
  fem::Material m;
  m.youngs_modulus = kYoung;
  m.poissons_ratio = 0.0;
  const double width = kHeight / across;
  TetMesh rest = mesh::box(Vec3(kLength, kHeight, width), {20 * across, across, 1});
  const Vec3 corner = rest.nodes.rowwise().minCoeff();
  rest.nodes.colwise() -= corner;
  Beam beam(rest, m, width);
  if (fault == "half-stiffness")
    beam.body.replace([](const auto& term) { return scaled(term, {.force = 0.5}); });
  if (fault == "small-strain")
    beam.body.replace([&](const auto& term) { return small_strain(term, rest.nodes.reshaped()); });
  std::vector<Bend> out;
  double before = 0.0;
  for (double a : loads) {
    bool solved = true;
    const int parts = static_cast<int>(std::ceil(a - before));
    for (int k = 1; k <= parts && solved; ++k) {
      const double P = beam.force_of(before + (a - before) * k / parts);
      beam.load(Vec3(0, -P, 0));
      solved = beam.body.solve();
    }
    const Vec3 u = beam.end_displacement() / kLength;
    out.push_back(solved ? Bend{-u.y(), -u.x()} : Bend{std::nan(""), std::nan("")});
    before = a;
  }
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  const std::vector<double> loads =
      fault.empty() ? std::vector<double>{1, 2, 3, 5, 10} : std::vector<double>{1};
  constexpr int kCoarse = 6, kFine = 8;
  const std::vector<Bend> coarse = bend(kCoarse, loads, fault), fine = bend(kFine, loads, fault);
  const double ratio = std::pow(static_cast<double>(kFine) / kCoarse, 2);
  // Error of order 2 removed.
  const auto limit = [&](double on_coarse, double on_fine) {
    return on_fine + (on_fine - on_coarse) / (ratio - 1.0);
  };
  std::vector<Measurement> out;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const Bend exact = elastica(loads[i]);
    const Bend found{limit(coarse[i].drop, fine[i].drop), limit(coarse[i].shortening, fine[i].shortening)};
    const std::string note = fmt::format("{:.5f} and {:.5f} with {} and {} elements across", coarse[i].drop,
                                         fine[i].drop, kCoarse, kFine);
    out.push_back({.quantity = fmt::format("drop/L at P L^2/(E I) = {}, extrapolated", loads[i]),
                   .computed = found.drop,
                   .exact = exact.drop,
                   .error = std::abs(found.drop / exact.drop - 1.0),
                   .bar = 0.01,
                   .note = note});
    out.push_back({.quantity = fmt::format("shortening/L at P L^2/(E I) = {}, extrapolated", loads[i]),
                   .computed = found.shortening,
                   .exact = exact.shortening,
                   .error = std::abs(found.shortening / exact.shortening - 1.0),
                   .bar = 0.01});
  }
  return out;
}

}  // namespace

ValidationCase large_deflection() {
  return {.name = "large-deflection",
          .section = "C",
          .summary =
              "slender cantilever under an end load that bends it by up to 75 degrees, against the elastica",
          .why =
              "corotated elements are designed for large rotation with small strain; Bisshopp and Drucker "
              "1945",
          .run = run,
          .faults = {{"half-stiffness", "/L at"}, {"small-strain", "/L at"}}};
}

}  // namespace palpate::validation
