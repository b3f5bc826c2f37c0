#include <cmath>

#include "cases.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Problem: a bar of two materials in series, held at x = 0 and pulled at x = L by a uniform traction s, sides
// free, nu = 0 in both.
//
// Exact answer: the axial stress is s everywhere, and F is diag(l_i, 1, 1) in layer i with s = E_i (l_i - 1)
// for any strain: the layers are springs in series,
//     u(L) = s (a/E_1 + b/E_2),     u(a) = s a/E_1,     energy = A s^2/2 (a/E_1 + b/E_2).
// Layers in parallel, pulled to the same stretch l, are springs in parallel:
//     force = (l - 1) (A_1 E_1 + A_2 E_2).
//
// Measured: displacements, energy and force. Linear elements contain this field, and their faces follow the
// border between the layers: exact to rounding on any such mesh, limit 1e-9.

namespace palpate::validation {
namespace {

constexpr double kLength = 1.0, kWidth = 0.3, kTraction = 2e3, kStretch = 1.1;
constexpr double kYoung[2] = {1e4, 3e5};

fem::Materials layers(const TetMesh& rest, int axis, const std::string& fault) {
  fem::Material soft, stiff;
  soft.youngs_modulus = kYoung[0];
  stiff.youngs_modulus = fault == "one-material" ? kYoung[0] : kYoung[1];
  soft.poissons_ratio = stiff.poissons_ratio = 0.0;
  fem::Materials out({soft, stiff}, {});
  for (const auto& tet : rest.tets.colwise()) {
    const double at = rest.nodes(axis, tet).mean();
    out.of_element.push_back(fault == "layers-swapped" ? at < 0.0 : at > 0.0);
  }
  return out;
}

/// Replaces the materials of the body according to the fault.
void misread(StaticBody& body, int axis, const std::string& fault) {
  if (!fault.empty())
    body.replace([&](const auto&) {
      return std::make_shared<fem::SoftBody>("body", body.rest(), layers(body.rest(), axis, fault),
                                             fem::SoftBodyOptions{}, 0);
    });
}

/// Returns a mesh around the origin whose inner nodes are perturbed, except in the plane where the layers
/// meet.
TetMesh bar(int axis) {
  std::array<int, 3> cells = {8, 4, 4};
  TetMesh rest = mesh::box(Vec3(kLength, kWidth, kWidth), cells);
  const std::vector<char> outside = boundary_nodes(rest);
  for (int i = 0; i < rest.nodes.cols(); ++i)
    if (!outside[static_cast<std::size_t>(i)])
      for (int k = 0; k < 3; ++k)
        if (k != axis || std::abs(rest.nodes(axis, i)) > 1e-9)
          rest.nodes(k, i) += 0.01 * std::sin(3.0 * i + k);
  return rest;
}

std::vector<Measurement> run(const std::string& fault) {
  const TetMesh rest = bar(0);
  StaticBody series(rest, layers(rest, 0, ""));
  misread(series, 0, fault);
  const double a = kLength / 2, ends = kTraction * (a / kYoung[0] + a / kYoung[1]),
               middle = kTraction * a / kYoung[0];
  const mesh::Boundary boundary = mesh::boundary(rest);
  for (const auto& face : boundary.surface.faces.colwise()) {
    const Mat3 x = boundary.surface.vertices(Eigen::all, face);
    if (x.row(0).minCoeff() < a - 1e-9) continue;
    const double area = 0.5 * (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm();
    for (int corner : face)
      series.load(boundary.node_of_vertex[static_cast<std::size_t>(corner)],
                  Vec3(kTraction * area / 3.0, 0, 0));
  }
  for (int i = 0; i < rest.nodes.cols(); ++i)
    if (rest.nodes(0, i) < -a + 1e-9) series.hold(i, Vec3(rest.nodes.col(i)));
  const bool solved = series.solve();
  double worst = solved ? 0.0 : std::nan(""), end = 0.0, middle_found = 0.0;
  for (int i = 0; i < rest.nodes.cols(); ++i) {
    const double x = rest.nodes(0, i);
    const double want = x < 0 ? kTraction * (x + a) / kYoung[0] : middle + kTraction * x / kYoung[1];
    worst = std::max(worst, (series.displacement(i) - Vec3(want, 0, 0)).norm() / ends);
    if (x > a - 1e-9) end = series.displacement(i).x();
    if (std::abs(x) < 1e-9) middle_found = series.displacement(i).x();
  }
  const double energy = series.elastic_energy(), exact_energy = 0.5 * kWidth * kWidth * kTraction * ends;

  const TetMesh side = bar(2);
  StaticBody parallel(side, layers(side, 2, ""));
  misread(parallel, 2, fault);
  for (int i = 0; i < side.nodes.cols(); ++i)
    if (std::abs(side.nodes(0, i)) > a - 1e-9) parallel.hold(i, 0, kStretch * side.nodes(0, i));
  for (int i = 0; i < side.nodes.cols(); ++i) {
    if (side.nodes(1, i) < -kWidth / 2 + 1e-9) parallel.hold(i, 1, side.nodes(1, i));
    if (side.nodes(2, i) < -kWidth / 2 + 1e-9) parallel.hold(i, 2, side.nodes(2, i));
  }
  double pull = parallel.solve() ? 0.0 : std::nan("");
  const Points forces = parallel.internal_forces();
  for (int i = 0; i < side.nodes.cols(); ++i)
    if (side.nodes(0, i) > a - 1e-9) pull -= forces(0, i);
  const double exact_pull = (kStretch - 1.0) * kWidth * kWidth / 2 * (kYoung[0] + kYoung[1]);

  const auto relative = [](double found, double exact) { return std::abs(found / exact - 1.0); };
  return {{.quantity = "layers in series: end displacement [m]",
           .computed = end,
           .exact = ends,
           .error = relative(end, ends),
           .bar = 1e-9},
          {.quantity = "the border between them [m]",
           .computed = middle_found,
           .exact = middle,
           .error = relative(middle_found, middle),
           .bar = 1e-9},
          {.quantity = "farthest node from the exact field / end displacement",
           .computed = worst,
           .exact = 0.0,
           .error = worst,
           .bar = 1e-9},
          {.quantity = "elastic energy [J]",
           .computed = energy,
           .exact = exact_energy,
           .error = relative(energy, exact_energy),
           .bar = 1e-9},
          {.quantity = "layers in parallel: force [N]",
           .computed = pull,
           .exact = exact_pull,
           .error = relative(pull, exact_pull),
           .bar = 1e-9}};
}

}  // namespace

ValidationCase layered_bar() {
  return {
      .name = "layered-bar",
      .section = "C",
      .summary = "a bar of two materials, 30 to 1 in stiffness, pulled: springs in series and in parallel",
      .why =
          "shows that each element has the material of its side of the border, and that both materials share "
          "the nodes on it; exact for nu = 0",
      .quick = true,
      .run = run,
      .faults = {{"one-material", "layers in parallel"}, {"layers-swapped", "the border between"}}};
}

}  // namespace palpate::validation
