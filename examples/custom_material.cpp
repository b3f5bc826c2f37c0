// Adds a custom material, as a force term over tetrahedra. A block is stretched to l = 1.5 times its length.
// By theory the force per area at rest is E/2 l (l^2 - 1), and the width becomes sqrt(1 - nu (l^2 - 1)).
#include <cmath>
#include <cstdio>

#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/generators.h"

using namespace palpate;
using Mat34 = Eigen::Matrix<double, 3, 4>;

// The law of Saint Venant and Kirchhoff, of the Green strain E = (F^T F - I)/2:
//     psi = mu |E|^2 + lambda/2 tr(E)^2,   P = dpsi/dF = F S,   S = 2 mu E + lambda tr(E) I.
// For another law, replace stress() and stress_change().
Mat3 second_stress(const Mat3& E, const fem::Material& m) {
  return 2.0 * m.mu() * E + m.lambda() * E.trace() * Mat3::Identity();
}
Mat3 stress(const Mat3& F, const fem::Material& m) {
  return F * second_stress(0.5 * (F.transpose() * F - Mat3::Identity()), m);
}
Mat3 stress_change(const Mat3& F, const Mat3& dF, const fem::Material& m) {
  const Mat3 E = 0.5 * (F.transpose() * F - Mat3::Identity()), FtdF = F.transpose() * dF;
  return dF * second_stress(E, m) + F * second_stress(0.5 * (FtdF + FtdF.transpose()), m);
}

struct Element {
  Eigen::Vector4i nodes;
  double volume;  ///< [m^3]
  Mat34 grad;     ///< Gradients of the four shape functions, one per column [1/m].
  /// Returns sum_a x_a (grad N_a)^T: F of positions x, dF of displacements x.
  Mat3 gradient_of(const auto& x) const {
    return x.reshaped(3, x.size() / 3)(Eigen::all, nodes) * grad.transpose();
  }
  /// Adds scale V P grad N_a to y_a, for each node a.
  void scatter(double scale, const Mat3& P, VecX& y) const {
    y.reshaped(3, y.size() / 3)(Eigen::all, nodes) += scale * volume * P * grad;
  }
};

class CustomBody : public dynamics::ForceTerm {
 public:
  CustomBody(const TetMesh& rest, const fem::Material& material) : material_(material) {
    for (const auto nodes : rest.tets.colwise()) {
      const Mat34 X = rest.nodes(Eigen::all, nodes);
      const Mat3 edges = X.rightCols<3>().colwise() - X.col(0), inverse = edges.inverse();
      Mat34 grad;
      grad << -inverse.colwise().sum().transpose(), inverse.transpose();
      elements_.push_back({nodes, edges.determinant() / 6.0, grad});
    }
  }
  std::string_view name() const override { return "custom"; }
  dynamics::TermTraits traits() const override { return {}; }  // stiff, with a symmetric tangent
  void add_pattern(dynamics::PatternBuilder& pattern) const override {
    for (const Element& e : elements_) pattern.add_clique(e.nodes.data(), 4);
  }
  void add_force(const dynamics::StateView& state, VecX& f) override {
    for (const Element& e : elements_) e.scatter(-1.0, stress(e.gradient_of(state.q), material_), f);
  }
  void apply_tangent(const dynamics::StateView& state, double k, double, const VecX& x, VecX& y) override {
    for (const Element& e : elements_)
      e.scatter(k, stress_change(e.gradient_of(state.q), e.gradient_of(x), material_), y);
  }
  /// Adds the blocks K_ab. Column j of block (a, b) is V dP grad N_a for a unit displacement of node b along
  /// axis j.
  void add_tangent(const dynamics::StateView& state, double k, double, dynamics::BorderedMatrix& A) override {
    for (const Element& e : elements_) {
      const Mat3 F = e.gradient_of(state.q);
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
          Mat3 K;
          for (int j = 0; j < 3; ++j)
            K.col(j) = stress_change(F, Vec3::Unit(j) * e.grad.col(b).transpose(), material_) * e.grad.col(a);
          A.body.add(A.body.slot(e.nodes[a], e.nodes[b]), k * e.volume * K);
        }
    }
  }

 private:
  fem::Material material_;
  std::vector<Element> elements_;
};

int main() {
  const double length = 0.04, side = 0.02;  // [m]
  const double stretch = 1.5, change = stretch * stretch - 1.0;
  const fem::Material rubber{.youngs_modulus = 1e4, .poissons_ratio = 0.3};
  const TetMesh mesh = mesh::box({length, side, side}, {4, 2, 2});
  const VecX x = (Vec3(stretch, 1, 1).asDiagonal() * mesh.nodes).reshaped();
  const int n = static_cast<int>(x.size());

  dynamics::State state;
  const int block = state.insert({.name = "block", .q_size = n, .u_size = n}, x, VecX::Zero(n));
  dynamics::System system;
  system.add(std::make_shared<CustomBody>(mesh, rubber));
  system.add(fem::make_lumped_mass(mesh, rubber.density, block));
  // Holds both ends along x, and the two lower sides along their normals; the two upper sides are free.
  const auto hold = [&](const char* axis, const Vec3& low, const Vec3& high) {
    const std::vector<int> dofs = fem::dofs_of_nodes(fem::nodes_in_box(mesh.nodes, low, high), 0, axis);
    system.add(fem::make_fixed(dofs, x(dofs)));
    return dofs;
  };
  hold("x", {-1, -1, -1}, {-length / 2, 1, 1});
  hold("y", {-1, -1, -1}, {1, -side / 2, 1});
  hold("z", {-1, -1, -1}, {1, 1, -side / 2});
  const std::vector<int> end = hold("x", {length / 2, -1, -1}, {1, 1, 1});
  system.prepare(state.view());

  const auto stepper = integrate::make_stepper(system, state, {.name = "kinsol-static", .rtol = 1e-8});
  const dynamics::StepResult result = stepper->advance_to(1.0);
  VecX reactions;  // forces that hold the given directions [N]
  system.reactions(state.view(), reactions);
  const VecX y = state.q().reshaped(3, n / 3).row(1);
  std::printf("%s: force %.6g N, by theory %.6g N; width %.6g m, by theory %.6g m\n",
              to_string(result.status), reactions(end).sum(),
              0.5 * rubber.youngs_modulus * stretch * change * side * side, y.maxCoeff() - y.minCoeff(),
              side * std::sqrt(1.0 - rubber.poissons_ratio * change));
}
