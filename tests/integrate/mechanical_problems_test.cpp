#include <gtest/gtest.h>

#include "integrate/fakes.h"

/// Small mechanical systems of the literature through the condensed Newton matrix, against Runge-Kutta-4 of
/// this file at tiny steps.
namespace palpate {
namespace {

using namespace fakes;
using Acceleration = std::function<VecX(const VecX& q)>;

/// Classical RK4 on q'' = a(q); error O(h^4), with h small enough to be below every bar here.
void reference(const Acceleration& a, VecX& q, VecX& u, double T, int steps) {
  const double h = T / steps;
  for (int n = 0; n < steps; ++n) {
    const VecX k1 = u, l1 = a(q), k2 = u + 0.5 * h * l1, l2 = a(q + 0.5 * h * k1), k3 = u + 0.5 * h * l2,
               l3 = a(q + 0.5 * h * k2), k4 = u + h * l3, l4 = a(q + h * k3);
    q += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    u += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
  }
}

/// A potential over one node block, with its Hessian.
struct Potential final : ForceTerm {
  std::function<double(const VecX&)> value;
  std::function<VecX(const VecX&)> gradient;
  std::function<MatX(const VecX&)> hessian;
  int nodes = 1;
  std::string_view name() const override { return "potential"; }
  TermTraits traits() const override { return {.conservative = true}; }
  void add_pattern(PatternBuilder& p) const override {
    std::vector<int> all;
    for (int i = 0; i < nodes; ++i) all.push_back(i);
    p.add_clique(all.data(), nodes);
  }
  void add_force(const StateView& s, VecX& f) override { f -= gradient(s.q); }
  void add_tangent(const StateView& s, double k, double, BorderedMatrix& A) override {
    const MatX H = k * hessian(s.q);
    for (int i = 0; i < nodes; ++i)
      for (int j = 0; j < nodes; ++j) A.body.add(A.body.slot(i, j), H.block<3, 3>(3 * i, 3 * j));
  }
  void apply_tangent(const StateView& s, double k, double, const VecX& x, VecX& y) override {
    y += k * (hessian(s.q) * x);
  }
  double energy(const StateView& s) override { return value(s.q); }
};

struct Problem {
  State state;
  System system;
  std::shared_ptr<Potential> potential;
  Problem(const VecX& q, const VecX& u, std::shared_ptr<Potential> p) : potential(std::move(p)) {
    const int id = state.insert(
        BlockSpec{
            .name = "points", .q_size = static_cast<int>(q.size()), .u_size = static_cast<int>(q.size())},
        q, u);
    system.add(std::static_pointer_cast<ForceTerm>(potential));
    system.add(std::make_shared<NodalMass>(id, MatX::Identity(q.size(), q.size())));
    system.prepare(state.view());
  }
  double energy() { return system.kinetic_energy(state.view()) + potential->value(state.q()); }
};

/// A unit mass on a spring of stiffness 1/eps^2 and length 1 under g = 1: the pendulum as eps -> 0 (Lubich
/// 1993).
std::shared_ptr<Potential> spring_pendulum(double k) {
  auto p = std::make_shared<Potential>();
  p->value = [k](const VecX& q) { return 0.5 * k * std::pow(q.norm() - 1.0, 2) + q[1]; };
  p->gradient = [k](const VecX& q) { return VecX(k * (q.norm() - 1.0) / q.norm() * q + VecX::Unit(3, 1)); };
  p->hessian = [k](const VecX& q) {
    const double r = q.norm();
    const VecX n = q / r;
    return MatX(k * (1.0 - 1.0 / r) * MatX::Identity(3, 3) + k / r * n * n.transpose());
  };
  return p;
}

/// Fermi-Pasta-Ulam with 3 stiff linear and 4 soft cubic springs, w = 50 (Hairer, Lubich, Wanner 2006,
/// I.5.1), along x; y and z of each mass are free and at rest.
std::shared_ptr<Potential> fermi_pasta_ulam(double w) {
  constexpr int kMasses = 6;
  auto p = std::make_shared<Potential>();
  p->nodes = kMasses;
  const auto x = [](const VecX& q, int i) { return i < 0 || i >= kMasses ? 0.0 : q[3 * i]; };
  // stiff springs join masses 2i and 2i + 1; soft ones join the wall and 0, 1 and 2, 3 and 4, 5 and the wall
  p->value = [=](const VecX& q) {
    double v = 0.0;
    for (int i = 0; i < kMasses; i += 2) v += 0.25 * w * w * std::pow(x(q, i + 1) - x(q, i), 2);
    for (int i = -1; i < kMasses; i += 2) v += std::pow(x(q, i + 1) - x(q, i), 4);
    return v;
  };
  p->gradient = [=](const VecX& q) {
    VecX g = VecX::Zero(q.size());
    const auto spring = [&](int i, double force) {
      if (i >= 0) g[3 * i] -= force;
      if (i + 1 < kMasses) g[3 * (i + 1)] += force;
    };
    for (int i = 0; i < kMasses; i += 2) spring(i, 0.5 * w * w * (x(q, i + 1) - x(q, i)));
    for (int i = -1; i < kMasses; i += 2) spring(i, 4.0 * std::pow(x(q, i + 1) - x(q, i), 3));
    return g;
  };
  p->hessian = [=](const VecX& q) {
    MatX H = MatX::Zero(q.size(), q.size());
    const auto spring = [&](int i, double k) {
      if (i >= 0) H(3 * i, 3 * i) += k;
      if (i + 1 < kMasses) H(3 * i + 3, 3 * i + 3) += k;
      if (i >= 0 && i + 1 < kMasses) H(3 * i, 3 * i + 3) -= k, H(3 * i + 3, 3 * i) -= k;
    };
    for (int i = 0; i < kMasses; i += 2) spring(i, 0.5 * w * w);
    for (int i = -1; i < kMasses; i += 2) spring(i, 12.0 * std::pow(x(q, i + 1) - x(q, i), 2));
    return H;
  };
  return p;
}

/// Methods with error control whose order lets them reach 1e-6 in seconds.
std::vector<std::string> accurate_methods() {
  std::vector<std::string> out;
  for (const auto& e : integrate::stepper_registry())
    if (e.traits.control != StepControl::kFixed && e.traits.order >= 3) out.push_back(e.name);
  return out;
}
class Mechanics : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Registry, Mechanics, testing::ValuesIn(accurate_methods()), registry_test_name);

void expect_reference(const std::string& name, const std::shared_ptr<Potential>& potential, const VecX& q0,
                      const VecX& u0, double T, double fastest) {
  VecX q = q0, u = u0;
  reference([&](const VecX& at) { return VecX(-potential->gradient(at)); }, q, u, T,
            static_cast<int>(std::ceil(T * fastest / 2e-3)));
  Problem problem(q0, u0, potential);
  const double energy = problem.energy();
  const auto stepper = integrate::make_stepper(problem.system, problem.state,
                                               {.name = name, .rtol = 1e-8, .max_steps = 5000000});
  const StepResult result = stepper->advance_to(T);
  ASSERT_TRUE(result.ok()) << result.message;
  EXPECT_LT((problem.state.q() - q).norm() / q.norm(), 2e-5);
  EXPECT_LT((problem.state.u() - u).norm() / std::max(1.0, u.norm()), 2e-4 * std::sqrt(fastest));
  // about 1 goes back and forth
  EXPECT_NEAR(problem.energy(), energy, 1e-4 * std::max(1.0, std::abs(energy)));
}

TEST_P(Mechanics, StiffSpringPendulum) {
  const double k = 1e4;
  const VecX q0 = (VecX(3) << 1.0 + 1e-3, 0.0, 0.0).finished();
  expect_reference(GetParam(), spring_pendulum(k), q0, VecX::Zero(3), 3.0, std::sqrt(k));
}

// x_i and its velocity as in the book: the first stiff spring carries energy 1/2 + 1/2.
TEST_P(Mechanics, FermiPastaUlamChain) {
  const double w = 50.0, root2 = std::sqrt(2.0);
  VecX q0 = VecX::Zero(18), u0 = VecX::Zero(18);
  // scaled expansion and centre of spring 1: x_1 = 1, y_1 = 1, z_1 = 1/w, and its velocity 1
  q0[0] = (1.0 - 1.0 / w) / root2;
  q0[3] = (1.0 + 1.0 / w) / root2;
  u0[0] = 0.0;
  u0[3] = 2.0 / root2;
  expect_reference(GetParam(), fermi_pasta_ulam(w), q0, u0, 3.0, w);
}

}  // namespace
}  // namespace palpate
