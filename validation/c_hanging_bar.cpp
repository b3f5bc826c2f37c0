#include <cmath>

#include "cases.h"
#include "faults.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Problem: a bar held at x = 0 under its weight along +x, nu = 0.
//
// Exact answer (one-dimensional theory): the stress is rho g (L - x), u(x) = rho g (L x - x^2/2)/E, and the
// elastic energy is the integral of A sigma^2/(2 E) = A (rho g)^2 L^3/(6 E). With nu = 0 and tension R = I,
// so that the nonlinear law has the same solution.
//
// Measured: energy and RMS error of the nodes; with linear elements both converge with order 2 (accepted: 1.8
// to 2.1; limit 1e-2). (The mean displacement of the tip is superconvergent and therefore not measured.)

namespace palpate::validation {
namespace {

constexpr double kLength = 1.0, kWidth = 0.25, kGravity = 9.81;

struct Errors {
  double h, energy, rms, computed_energy, exact_energy, computed_rms;
};

Errors bar(int cells_along, const std::string& fault) {
  fem::Material m;
  m.youngs_modulus = 1e6;
  m.poissons_ratio = 0.0;
  const double e = m.youngs_modulus, weight = m.density * kGravity;
  TetMesh rest = mesh::box(Vec3(kLength, kWidth, kWidth), {cells_along, cells_along / 4, cells_along / 4});
  const Vec3 corner = rest.nodes.rowwise().minCoeff();
  rest.nodes.colwise() -= corner;
  StaticBody body(rest, m);
  if (fault == "half-stiffness") body.replace([](const auto& term) { return scaled(term, {.force = 0.5}); });
  // Lumps masses by a first-order rule: the weight of each element acts on its node nearest to the fixed end.
  if (fault == "one-point-weight") {
    const TetMesh& mesh = body.rest();
    for (const auto& tet : mesh.tets.colwise()) {
      int nearest = tet[0];
      for (int a = 1; a < 4; ++a)
        if (mesh.nodes(0, tet[a]) < mesh.nodes(0, nearest)) nearest = tet[a];
      body.load(nearest, Vec3(weight * volume({mesh.nodes, tet}), 0, 0));
    }
  } else {
    const VecX masses = fem::lumped_masses(rest, m.density);
    for (int i = 0; i < rest.nodes.cols(); ++i) body.load(i, Vec3(kGravity * masses[i], 0, 0));
  }
  for (int i = 0; i < rest.nodes.cols(); ++i)
    if (rest.nodes(0, i) < 1e-9) body.hold(i, Vec3(rest.nodes.col(i)));
  const bool solved = body.solve();

  double sum = 0.0, exact_sum = 0.0;
  for (int i = 0; i < rest.nodes.cols(); ++i) {
    const double x = rest.nodes(0, i), u = weight * (kLength * x - 0.5 * x * x) / e;
    sum += (body.displacement(i) - Vec3(u, 0, 0)).squaredNorm();
    exact_sum += u * u;
  }
  Errors out;
  out.h = kLength / cells_along;
  out.exact_energy = kWidth * kWidth * weight * weight * std::pow(kLength, 3) / (6.0 * e);
  out.computed_energy = solved ? body.elastic_energy() : std::nan("");
  out.energy = std::abs(out.computed_energy / out.exact_energy - 1.0);
  out.rms = solved ? std::sqrt(sum / exact_sum) : std::nan("");
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<double> h, energy, rms;
  Errors last{};
  for (int cells : {8, 16, 32}) {
    last = bar(cells, fault);
    h.push_back(last.h);
    energy.push_back(last.energy);
    rms.push_back(last.rms);
  }
  return {{.quantity = "elastic energy [J], 32 cells along",
           .computed = last.computed_energy,
           .exact = last.exact_energy,
           .error = last.energy,
           .bar = 1e-2,
           .order = validation::fitted_order(h, energy),
           .order_low = 1.8,
           .order_high = 2.1,
           .refinement = {"element size [m]", h, energy}},
          {.quantity = "RMS error of the nodes / RMS displacement, 32 cells along",
           .computed = last.rms,
           .exact = 0.0,
           .error = last.rms,
           .bar = 1e-2,
           .order = validation::fitted_order(h, rms),
           .order_low = 1.8,
           .order_high = 2.1,
           .refinement = {"element size [m]", h, rms}}};
}

}  // namespace

ValidationCase hanging_bar() {
  return {.name = "hanging-bar",
          .section = "C",
          .summary =
              "bar under its own weight, nu = 0: elastic energy and displacement of all nodes, order in the "
              "element size",
          .why =
              "the simplest non-uniform stress: shows that weight, stiffness and mesh refinement fit "
              "together; one-dimensional theory",
          .quick = true,
          .run = run,
          .faults = {{"half-stiffness", "32 cells along"}, {"one-point-weight", "RMS error"}}};
}

}  // namespace palpate::validation
