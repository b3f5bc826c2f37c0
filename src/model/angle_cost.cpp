#include "model/angle_cost.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "palpate/mesh/generators.h"
#include "palpate/mesh/quality.h"

// K of a linear tetrahedron with the gradients g_a of its shape functions:
//   K_ab = V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I),
// with Lame's constants lambda and mu.  M^-1/2 K M^-1/2 has the eigenvalues of M^-1 K and is symmetric, as
// the Lanczos method requires.  The largest eigenvalue converges without reorthogonalisation (Paige 1976);
// slivers separate it from the rest of the spectrum, so that few steps suffice.
namespace palpate::model {
namespace {

struct Element {
  std::array<int, 4> nodes;
  std::array<Vec3, 4> gradients;
  double volume;
};

struct Matrix {
  std::vector<Element> elements;
  VecX inverse_root_mass;  ///< per node

  VecX times(const VecX& x) const {
    constexpr double kLambda = AngleCost::kYoungsModulus * AngleCost::kPoissonsRatio /
                               ((1 + AngleCost::kPoissonsRatio) * (1 - 2 * AngleCost::kPoissonsRatio)),
                     kMu = AngleCost::kYoungsModulus / (2 * (1 + AngleCost::kPoissonsRatio));
    VecX out = VecX::Zero(x.size());
    for (const Element& e : elements) {
      Mat3 gradient = Mat3::Zero();  // displacement gradient
      for (std::size_t a = 0; a < 4; ++a)
        gradient += inverse_root_mass[e.nodes[a]] * x.segment<3>(3 * e.nodes[a]) * e.gradients[a].transpose();
      const Mat3 stress =
          kLambda * gradient.trace() * Mat3::Identity() + kMu * (gradient + gradient.transpose());
      for (std::size_t a = 0; a < 4; ++a)
        out.segment<3>(3 * e.nodes[a]) +=
            inverse_root_mass[e.nodes[a]] * e.volume * (stress * e.gradients[a]);
    }
    return out;
  }
};

Matrix matrix_of(const TetMesh& mesh) {
  Matrix out;
  VecX mass = VecX::Zero(mesh.nodes.cols());
  for (int t = 0; t < static_cast<int>(mesh.tets.cols()); ++t) {
    Element e{};
    for (int k = 0; k < 4; ++k) e.nodes[static_cast<std::size_t>(k)] = mesh.tets(k, t);
    Mat3 edges;
    for (int k = 0; k < 3; ++k)
      edges.col(k) = mesh.nodes.col(mesh.tets(k + 1, t)) - mesh.nodes.col(mesh.tets(0, t));
    const Mat3 inverse = edges.inverse();
    e.volume = mesh::tet_volume(mesh, t);
    e.gradients[0] = -inverse.colwise().sum().transpose();
    for (std::size_t k = 0; k < 3; ++k) e.gradients[k + 1] = inverse.row(static_cast<int>(k)).transpose();
    for (const int node : e.nodes) mass[node] += AngleCost::kDensity * e.volume / 4;
    out.elements.push_back(e);
  }
  out.inverse_root_mass = mass.cwiseSqrt().cwiseInverse();
  return out;
}

}  // namespace

double largest_eigenvalue(const TetMesh& mesh) {
  constexpr int kSteps = 60;
  const Matrix matrix = matrix_of(mesh);
  VecX q(3 * mesh.nodes.cols());
  for (Eigen::Index i = 0; i < q.size(); ++i) q[i] = std::sin(1.0 + 7.0 * static_cast<double>(i));
  q.normalize();
  VecX before = VecX::Zero(q.size());
  std::vector<double> diagonal, beside;
  for (int step = 0; step < kSteps; ++step) {
    VecX r = matrix.times(q) - (beside.empty() ? 0.0 : beside.back()) * before;
    diagonal.push_back(r.dot(q));
    r -= diagonal.back() * q;
    const double size = r.norm();
    if (step + 1 == kSteps || !(size > 1e-12 * std::abs(diagonal.front()))) break;
    beside.push_back(size);
    before = q;
    q = r / size;
  }
  Eigen::SelfAdjointEigenSolver<MatX> solver;
  const VecX d = Eigen::Map<const VecX>(diagonal.data(), static_cast<Eigen::Index>(diagonal.size())),
             s = Eigen::Map<const VecX>(beside.data(), static_cast<Eigen::Index>(diagonal.size()) - 1);
  solver.computeFromTridiagonal(d, s, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().maxCoeff();
}

AngleCost price_of_angles(const TetMesh& mesh, double bound_deg) {
  AngleCost out;
  out.bound_deg = bound_deg;
  out.all = static_cast<int>(mesh.tets.cols());
  double volume = 0;
  for (int t = 0; t < out.all; ++t) {
    const auto angles = mesh::dihedral_angles(mesh, t);
    out.bad += *std::min_element(angles.begin(), angles.end()) * 180 / std::numbers::pi < bound_deg;
    volume += mesh::tet_volume(mesh, t);
  }
  constexpr int kCells = 8;
  const double cell = std::cbrt(5 * volume / out.all);
  const auto set = [](double eigenvalue, double& step, double& condition) {
    step = 2 / std::sqrt(eigenvalue);
    condition = 1 + AngleCost::kImplicitStep * AngleCost::kImplicitStep * eigenvalue;
  };
  set(largest_eigenvalue(mesh), out.explicit_step_s, out.condition);
  set(largest_eigenvalue(mesh::box(Vec3::Constant(kCells * cell), {kCells, kCells, kCells})),
      out.good_explicit_step_s, out.good_condition);
  return out;
}

std::string text(const AngleCost& cost) {
  return fmt::format(
      "{} of {} tetrahedra have angles below {:g} degrees and are accepted: explicit methods are stable up "
      "to steps of {:.2g} s, against {:.2g} s for tetrahedra of 55 degrees and the same mean volume (E = "
      "{:g} Pa, nu = {:g}, {:g} kg/m^3), and take {:.3g} times as many steps; the condition number of an "
      "implicit step of {:g} ms is {:.3g} instead of {:.3g}, that of a static solve {:.3g} times as large",
      cost.bad, cost.all, cost.bound_deg, cost.explicit_step_s, cost.good_explicit_step_s,
      AngleCost::kYoungsModulus, AngleCost::kPoissonsRatio, AngleCost::kDensity,
      cost.good_explicit_step_s / cost.explicit_step_s, 1e3 * AngleCost::kImplicitStep, cost.condition,
      cost.good_condition, std::pow(cost.good_explicit_step_s / cost.explicit_step_s, 2));
}

}  // namespace palpate::model
