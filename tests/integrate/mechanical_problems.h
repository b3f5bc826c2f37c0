#pragma once
#include "integrate/fakes.h"

/// Small mechanical systems from the literature, with a Runge-Kutta-4 integrator as their reference.
namespace palpate::fakes {

/// A potential over one node block, with its Hessian.
struct Potential final : ForceTerm {
  std::function<double(const VecX&)> value;
  std::function<VecX(const VecX&)> gradient;
  std::function<MatX(const VecX&)> hessian;
  int nodes = 1;
  TermTraits kind{.conservative = true};
  std::string_view name() const override { return "potential"; }
  TermTraits traits() const override { return kind; }
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

using Potentials = std::vector<std::shared_ptr<Potential>>;

/// Classical RK4 on q'' = -sum of gradients; error O(h^4), with h small enough for the error to be below
/// every limit here.
inline void reference(const Potentials& potentials, VecX& q, VecX& u, double T, int steps) {
  const auto a = [&](const VecX& at) {
    VecX sum = VecX::Zero(at.size());
    for (const auto& p : potentials) sum -= p->gradient(at);
    return sum;
  };
  const double h = T / steps;
  for (int n = 0; n < steps; ++n) {
    const VecX k1 = u, l1 = a(q), k2 = u + 0.5 * h * l1, l2 = a(q + 0.5 * h * k1), k3 = u + 0.5 * h * l2,
               l3 = a(q + 0.5 * h * k2), k4 = u + h * l3, l4 = a(q + h * k3);
    q += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    u += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
  }
}

struct Problem {
  State state;
  System system;
  Problem(const VecX& q, const VecX& u, const Potentials& potentials) {
    const int id = state.insert(
        BlockSpec{
            .name = "points", .q_size = static_cast<int>(q.size()), .u_size = static_cast<int>(q.size())},
        q, u);
    for (const auto& p : potentials) system.add(std::static_pointer_cast<ForceTerm>(p));
    system.add(std::make_shared<NodalMass>(id, MatX::Identity(q.size(), q.size())));
    system.prepare(state.view());
  }
  double energy() { return system.kinetic_energy(state.view()) + system.potential_energy(state.view()); }
};

/// A unit mass on a spring of stiffness 1/eps^2 and length 1 under g = 1: the pendulum as eps -> 0 (Lubich
/// 1993).
inline std::shared_ptr<Potential> spring_pendulum(double k) {
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

/// Potential of a soft floor under a point, V = v e^(-(y + 0.8)/0.1).
inline std::shared_ptr<Potential> exponential_floor(double v) {
  const auto at = [v](const VecX& q) { return v * std::exp(-(q[1] + 0.8) / 0.1); };
  auto p = std::make_shared<Potential>();
  p->value = at;
  p->gradient = [at](const VecX& q) { return VecX(-at(q) / 0.1 * VecX::Unit(3, 1)); };
  p->hessian = [at](const VecX& q) {
    return MatX(at(q) / 0.01 * VecX::Unit(3, 1) * VecX::Unit(3, 1).transpose());
  };
  return p;
}

/// Fermi-Pasta-Ulam problem with 3 stiff linear and 4 soft cubic springs (Hairer, Lubich, Wanner 2006,
/// I.5.1), along x; y and z of each mass are free and at rest.
namespace fermi_pasta_ulam {

inline constexpr int kMasses = 6;
inline double x(const VecX& q, int i) { return i < 0 || i >= kMasses ? 0.0 : q[3 * i]; }

/// Springs between masses i and i + 1 for i = first, first + 2, ..; -1 and kMasses are walls.
/// @param energy, force, stiffness  functions of a spring's elongation
inline std::shared_ptr<Potential> springs(int first, std::function<double(double)> energy,
                                          std::function<double(double)> force,
                                          std::function<double(double)> stiffness) {
  auto p = std::make_shared<Potential>();
  p->nodes = kMasses;
  const auto stretch = [](const VecX& q, int i) { return x(q, i + 1) - x(q, i); };
  p->value = [=](const VecX& q) {
    double v = 0.0;
    for (int i = first; i < kMasses; i += 2) v += energy(stretch(q, i));
    return v;
  };
  p->gradient = [=](const VecX& q) {
    VecX g = VecX::Zero(q.size());
    for (int i = first; i < kMasses; i += 2) {
      if (i >= 0) g[3 * i] -= force(stretch(q, i));
      if (i + 1 < kMasses) g[3 * (i + 1)] += force(stretch(q, i));
    }
    return g;
  };
  p->hessian = [=](const VecX& q) {
    MatX H = MatX::Zero(q.size(), q.size());
    for (int i = first; i < kMasses; i += 2) {
      const double k = stiffness(stretch(q, i));
      if (i >= 0) H(3 * i, 3 * i) += k;
      if (i + 1 < kMasses) H(3 * i + 3, 3 * i + 3) += k;
      if (i >= 0 && i + 1 < kMasses) H(3 * i, 3 * i + 3) -= k, H(3 * i + 3, 3 * i) -= k;
    }
    return H;
  };
  return p;
}

/// Stiff springs within the pairs 0 and 1, 2 and 3, 4 and 5.
inline std::shared_ptr<Potential> stiff(double w) {
  return springs(
      0, [w](double e) { return 0.25 * w * w * e * e; }, [w](double e) { return 0.5 * w * w * e; },
      [w](double) { return 0.5 * w * w; });
}
/// Soft springs between the pairs, and from the first and the last mass to the walls.
inline std::shared_ptr<Potential> soft() {
  return springs(
      -1, [](double e) { return std::pow(e, 4); }, [](double e) { return 4.0 * std::pow(e, 3); },
      [](double e) { return 12.0 * e * e; });
}

/// Initial state of the book, x_1 = 1, y_1 = 1, z_1 = 1/w with velocity 1: the first stiff spring has energy
/// 1/2 + 1/2.
inline VecX q0(double w) {
  VecX q = VecX::Zero(3 * kMasses);
  q[0] = (1.0 - 1.0 / w) / std::sqrt(2.0);
  q[3] = (1.0 + 1.0 / w) / std::sqrt(2.0);
  return q;
}
inline VecX u0() { return std::sqrt(2.0) * VecX::Unit(3 * kMasses, 3); }

}  // namespace fermi_pasta_ulam

}  // namespace palpate::fakes
