#include <array>
#include <cmath>
#include <random>

#include "cases.h"
#include "faults.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Problem: volumetric locking. A cantilever in plane strain, height D, 0 <= x <= L, is bent by the parabolic
// shear stress
//     tau = -(P/(2I)) (D^2/4 - y^2)
// on its end (per unit width, I = D^3/12).
//
// Exact answer. With E' = E/(1 - nu^2) and nu' = nu/(1 - nu) the field for every nu up to 1/2 is as follows
// (Timoshenko and Goodier, Theory of Elasticity, 21; the displacements as in Augarde and Deeks 2008, checked
// here by differentiation: sigma_xx = P (L-x) y/I, sigma_yy = 0, tau above):
//
//   u_x =  P y/(6 E'I) [(6L - 3x) x + (2 + nu') (y^2 - D^2/4)],
//   u_y = -P/(6 E'I) [3 nu' y^2 (L - x) + (4 + 5 nu') D^2 x/4 + (3L - x) x^2].
//
// It is prescribed on x = 0. u_x is odd in y: half the height with u_x = 0 on y = 0. Plane strain: u_z = 0 on
// both sides.
//
// Measured: tip deflection relative to the exact one, and order of the RMS error. At fixed element size and
// lambda -> inf the plain elements keep only the fields without volume change in any tetrahedron, hardly any:
// the deflection falls to a fraction of the exact one that no longer depends on lambda. A method that does
// not lock has an error uniform in nu (Babuska and Suri 1992), and order 2 in the displacements at every nu
// (limits: deflection 5 %, order 1.7 to 2.3).

namespace palpate::validation {
namespace {

constexpr double kLength = 4.0, kHeight = 1.0, kWidth = 0.25, kYoung = 1e6, kLoad = 1.0;

struct Exact {
  double E, nu, I = std::pow(kHeight, 3) / 12.0;
  explicit Exact(double poissons_ratio)
      : E(kYoung / (1.0 - poissons_ratio * poissons_ratio)), nu(poissons_ratio / (1.0 - poissons_ratio)) {}
  Vec3 displacement(const Vec3& X) const {
    const double x = X.x(), y = X.y(), scale = kLoad / (6.0 * E * I), quarter = 0.25 * kHeight * kHeight;
    return {scale * y * ((6.0 * kLength - 3.0 * x) * x + (2.0 + nu) * (y * y - quarter)),
            -scale * (3.0 * nu * y * y * (kLength - x) + (4.0 + 5.0 * nu) * quarter * x +
                      (3.0 * kLength - x) * x * x),
            0.0};
  }
  double traction(double y) const { return -kLoad / (2.0 * I) * (0.25 * kHeight * kHeight - y * y); }
};

/// Returns the half beam in cells of six tetrahedra around a diagonal, each node moved at random by up to
/// 0.15 cells along the axes on whose end faces it does not lie. (The constraints in the mirrored
/// five-tetrahedra cells of mesh::box depend on each other, as in crossed triangles in the plane, so that
/// these meshes hardly lock: they do not represent users' meshes.)
TetMesh irregular(const std::array<int, 3>& cells) {
  const Vec3 size(kLength, 0.5 * kHeight, kWidth);
  const auto node = [&](const std::array<int, 3>& at) {
    return (at[0] * (cells[1] + 1) + at[1]) * (cells[2] + 1) + at[2];
  };
  TetMesh mesh;
  mesh.nodes.resize(3, (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1));
  mesh.tets.resize(4, 6 * cells[0] * cells[1] * cells[2]);
  std::mt19937 engine(61);
  std::uniform_real_distribution<double> uniform(-0.15, 0.15);
  const std::size_t paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  Eigen::Index e = 0;
  std::array<int, 3> at{};
  for (at[0] = 0; at[0] <= cells[0]; ++at[0])
    for (at[1] = 0; at[1] <= cells[1]; ++at[1])
      for (at[2] = 0; at[2] <= cells[2]; ++at[2]) {
        bool cell = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const bool inside = at[axis] > 0 && at[axis] < cells[axis];
          mesh.nodes(static_cast<int>(axis), node(at)) =
              (at[axis] + (inside ? uniform(engine) : 0.0)) * size[static_cast<int>(axis)] / cells[axis];
          cell = cell && at[axis] < cells[axis];
        }
        for (int p = 0; cell && p < 6; ++p, ++e) {
          std::array<int, 3> corner = at;
          mesh.tets(0, e) = node(corner);
          for (int s = 0; s < 3; ++s) {
            ++corner[paths[p][s]];
            mesh.tets(s + 1, e) = node(corner);
          }
          if (p >= 3) std::swap(mesh.tets(2, e), mesh.tets(3, e));  // Odd permutations.
        }
      }
  return mesh;
}

struct Found {
  double tip;    ///< Deflection of the centre of the end over the exact one.
  double error;  ///< RMS error of the nodes over RMS displacement.
};

Found bend(double nu, int cells, bool nodal, const std::string& fault) {
  const Exact exact(nu);
  fem::Material m;
  m.youngs_modulus = kYoung;
  m.poissons_ratio = nu;
  fem::SoftBodyOptions options;
  if (nodal && fault != "plain-elements") options.volumetric_share = fem::kept_volumetric_share(m);
  const TetMesh rest = irregular({8 * cells, cells, std::max(1, cells / 2)});
  StaticBody body(rest, m, options);
  if (fault == "dilatation-lost")  // Leaves only the volumetric share that the elements keep.
    body.replace([](const StaticBody::Force& term) {
      const bool nodes = dynamic_cast<const fem::NodalDilatation*>(term.get()) != nullptr;
      return nodes ? scaled(term, {.force = 0.0, .energy = 0.0}) : term;
    });
  for (int i = 0; i < rest.nodes.cols(); ++i) {
    const Vec3 X = rest.nodes.col(i), x = X + exact.displacement(X);
    if (X.x() < 1e-9) {
      body.hold(i, 0, x.x());
      body.hold(i, 1, x.y());
    }
    if (X.y() < 1e-9) body.hold(i, 0, X.x());
    if (X.z() < 1e-9 || X.z() > kWidth - 1e-9) body.hold(i, 2, X.z());
  }
  const VecX loads = end_loads(body.rest(), kLength, [&](double y) { return exact.traction(y); });
  for (int i = 0; i < loads.size(); ++i) body.load(i, Vec3(0, loads[i], 0));
  if (!body.solve()) return {std::nan(""), std::nan("")};
  double sum = 0.0, of = 0.0;
  Found out{};
  for (int i = 0; i < rest.nodes.cols(); ++i) {
    const Vec3 X = rest.nodes.col(i), u = exact.displacement(X);
    sum += (body.displacement(i) - u).squaredNorm();
    of += u.squaredNorm();
    if (X.x() > kLength - 1e-9 && X.y() < 1e-9 && X.z() < 1e-9) out.tip = body.displacement(i).y() / u.y();
  }
  out.error = std::sqrt(sum / of);
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  constexpr double kWorst = 0.4999;
  constexpr int kFine = 8;
  std::vector<Measurement> out;
  Found plain{}, nodal{}, easy{};
  for (double nu : {0.3, 0.45, 0.49, 0.499, kWorst}) {
    if (!fault.empty() && nu != kWorst) continue;  // A fault is detected at this nu.
    plain = bend(nu, kFine, false, fault);
    nodal = bend(nu, kFine, true, fault);
    if (nu == 0.3) easy = nodal;
    out.push_back({.quantity = fmt::format("tip deflection / exact at nu = {}, nodal dilatation", nu),
                   .computed = nodal.tip,
                   .exact = 1.0,
                   .error = std::abs(nodal.tip - 1.0),
                   .bar = 0.05,
                   .note = fmt::format("plain elements: {:.4f}; 16 cells over the height", plain.tip)});
  }
  if (!fault.empty()) return out;
  std::vector<double> h, error;
  for (int cells : {4, 6, kFine}) {
    h.push_back(0.5 * kHeight / cells);
    error.push_back(bend(kWorst, cells, true, fault).error);
  }
  out.push_back({.quantity = "nodal dilatation at nu = 0.4999: RMS error of the nodes",
                 .computed = error.back(),
                 .exact = 0.0,
                 .error = error.back(),
                 .bar = 0.05,
                 .order = validation::fitted_order(h, error),
                 .order_low = 1.7,
                 .order_high = 2.3,
                 .note = "8, 12, 16 cells over the height",
                 .refinement = {"element size [m]", h, error}});
  out.push_back({.quantity = "RMS error at nu = 0.4999 over that at nu = 0.3",
                 .computed = error.back() / easy.error,
                 .exact = 1.0,
                 .error = error.back() / easy.error,
                 .bar = 2.0,
                 .note = "uniform in nu: no locking"});
  out.push_back({.quantity = "RMS error at nu = 0.4999 over that of plain elements",
                 .computed = error.back() / plain.error,
                 .exact = 0.0,
                 .error = error.back() / plain.error,
                 .bar = 0.1,
                 .note = fmt::format("plain elements: error {:.3f}", plain.error)});
  out.push_back({.quantity = "plain elements lock: their tip deflection / exact at nu = 0.4999",
                 .computed = plain.tip,
                 .exact = 0.0,
                 .error = plain.tip,
                 .bar = 0.5});
  return out;
}

}  // namespace

ValidationCase locking() {
  return {
      .name = "locking",
      .section = "C",
      .summary =
          "cantilever in plane strain for nu = 0.3 to 0.4999: plain elements lock, nodal dilatation does not",
      .why =
          "soft tissue is nearly incompressible; exact field of Timoshenko and Goodier, locking as in "
          "Babuska and Suri 1992",
      .run = run,
      .faults = {{"plain-elements", "nu = 0.4999, nodal dilatation"},
                 {"dilatation-lost", "nu = 0.4999, nodal dilatation"}}};
}

}  // namespace palpate::validation
