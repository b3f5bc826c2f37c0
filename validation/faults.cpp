#include "faults.h"

#include "palpate/integrate/integrators.h"

namespace palpate::validation {
namespace {

using dynamics::BorderedMatrix;
using dynamics::StateView;

class ScaledTerm final : public DecoratedTerm {
 public:
  ScaledTerm(std::shared_ptr<dynamics::ForceTerm> term, const Shares& shares)
      : DecoratedTerm(std::move(term)), shares_(shares) {}
  void add_force(const StateView& state, VecX& f) override {
    own_ = VecX::Zero(f.size());
    term().add_force(state, own_);
    f += shares_.force * own_;
  }
  void add_tangent(const StateView& state, double k, double d, BorderedMatrix& A) override {
    term().add_tangent(state, stiffness(k), damping(d), A);
  }
  void apply_tangent(const StateView& state, double k, double d, const VecX& x, VecX& y) override {
    term().apply_tangent(state, stiffness(k), damping(d), x, y);
  }
  double energy(const StateView& state) override { return shares_.energy * term().energy(state); }

 private:
  double stiffness(double k) const { return shares_.force * shares_.stiffness * k; }
  double damping(double d) const { return shares_.force * shares_.damping * d; }
  Shares shares_;
  VecX own_;
};

class SmallStrain final : public DecoratedTerm {
 public:
  SmallStrain(std::shared_ptr<dynamics::ForceTerm> term, VecX rest)
      : DecoratedTerm(std::move(term)), rest_(std::move(rest)), still_(VecX::Zero(rest_.size())) {}
  void add_force(const StateView& state, VecX& f) override {
    displacement_ = state.q - rest_;
    term().apply_tangent(at_rest(state), -1.0, 0.0, displacement_, f);
    displacement_ = state.u;
    term().apply_tangent(at_rest(state), 0.0, -1.0, displacement_, f);
  }
  void add_tangent(const StateView& state, double k, double d, BorderedMatrix& A) override {
    term().add_tangent(at_rest(state), k, d, A);
  }
  void apply_tangent(const StateView& state, double k, double d, const VecX& x, VecX& y) override {
    term().apply_tangent(at_rest(state), k, d, x, y);
  }
  double energy(const StateView& state) override {
    VecX force = VecX::Zero(rest_.size());
    const VecX u = state.q - rest_;
    term().apply_tangent(at_rest(state), 1.0, 0.0, u, force);
    return 0.5 * u.dot(force);
  }

 private:
  StateView at_rest(const StateView& state) const {
    return dynamics::make_view(*state.layout, state.time, rest_.data(), still_.data());
  }
  VecX rest_, still_, displacement_;
};

class RayleighDamping final : public DecoratedTerm {
 public:
  RayleighDamping(std::shared_ptr<dynamics::ForceTerm> term, VecX rest, double beta)
      : DecoratedTerm(std::move(term)), rest_(std::move(rest)), beta_(beta) {}
  void add_force(const StateView& state, VecX& f) override {
    term().add_force(state, f);
    term().apply_tangent(at_rest(state), -beta_, 0.0, VecX(state.u), f);
  }
  void add_tangent(const StateView& state, double k, double d, BorderedMatrix& A) override {
    term().add_tangent(state, k, d, A);
    term().add_tangent(at_rest(state), d * beta_, 0.0, A);
  }
  void apply_tangent(const StateView& state, double k, double d, const VecX& x, VecX& y) override {
    term().apply_tangent(state, k, d, x, y);
    term().apply_tangent(at_rest(state), d * beta_, 0.0, x, y);
  }

 private:
  StateView at_rest(const StateView& state) const {
    return dynamics::make_view(*state.layout, state.time, rest_.data(), state.u.data());
  }
  VecX rest_;
  double beta_;
};

// With f(u) = f(0) + g(u), the defect is e(u) = share g(s u)/s - g(u), with s = 1, or so small that g is
// linear.
class FrictionDefect final : public DecoratedTerm {
 public:
  FrictionDefect(std::shared_ptr<contact::ContactForce> contact, double share, bool linear)
      : DecoratedTerm(std::move(contact)), share_(share), scale_(linear ? 1e-6 : 1.0) {}
  void add_force(const StateView& state, VecX& f) override {
    add(state, share_ / scale_, scale_, f);
    add(state, -share_ / scale_, 0.0, f);
    add(state, -1.0, 1.0, f);
    add(state, 1.0, 0.0, f);
  }
  void add_tangent(const StateView& state, double, double d, BorderedMatrix& A) override {
    term().add_tangent(slowed(state, scale_), 0.0, share_ * d, A);
    term().add_tangent(state, 0.0, -d, A);
  }
  void apply_tangent(const StateView& state, double, double d, const VecX& x, VecX& y) override {
    term().apply_tangent(slowed(state, scale_), 0.0, share_ * d, x, y);
    term().apply_tangent(state, 0.0, -d, x, y);
  }
  double energy(const StateView&) override { return 0.0; }

 private:
  StateView slowed(const StateView& state, double factor) {
    slow_ = factor * state.u;
    return dynamics::make_view(*state.layout, state.time, state.q.data(), slow_.data());
  }
  void add(const StateView& state, double share, double factor, VecX& f) {
    own_ = VecX::Zero(f.size());
    term().add_force(slowed(state, factor), own_);
    f += share * own_;
  }
  double share_, scale_;
  VecX slow_, own_;
};

class ScaledInertia final : public dynamics::InertiaTerm {
 public:
  ScaledInertia(std::shared_ptr<dynamics::InertiaTerm> mass, double factor)
      : mass_(std::move(mass)), factor_(factor) {}
  int block_id() const override { return mass_->block_id(); }
  bool diagonal() const override { return mass_->diagonal(); }
  void add_pattern(dynamics::PatternBuilder& pattern) const override { mass_->add_pattern(pattern); }
  void add_mass(const StateView& state, double scale, BorderedMatrix& A) const override {
    mass_->add_mass(state, factor_ * scale, A);
  }
  void apply(const StateView& state, const VecX& x, VecX& y) const override {
    mass_->apply(state, VecX(factor_ * x), y);
  }

 private:
  std::shared_ptr<dynamics::InertiaTerm> mass_;
  double factor_;
};

template <class Term>
void add_term(loop::World& world, std::shared_ptr<Term> term) {
  world.system.add(std::move(term));
  world.system.prepare(world.state.view());
  world.stepper = integrate::make_stepper(world.system, world.state, world.description.integrator);
}

}  // namespace

std::shared_ptr<dynamics::ForceTerm> scaled(std::shared_ptr<dynamics::ForceTerm> term, const Shares& shares) {
  return std::make_shared<ScaledTerm>(std::move(term), shares);
}

std::shared_ptr<dynamics::ForceTerm> small_strain(std::shared_ptr<dynamics::ForceTerm> term, VecX rest) {
  return std::make_shared<SmallStrain>(std::move(term), std::move(rest));
}

std::shared_ptr<dynamics::ForceTerm> with_rayleigh_damping(std::shared_ptr<dynamics::ForceTerm> term,
                                                           VecX rest, double beta) {
  return std::make_shared<RayleighDamping>(std::move(term), std::move(rest), beta);
}

std::shared_ptr<dynamics::ForceTerm> friction_defect(std::shared_ptr<contact::ContactForce> contact,
                                                     double share, bool linear) {
  return std::make_shared<FrictionDefect>(std::move(contact), share, linear);
}

std::shared_ptr<dynamics::InertiaTerm> scaled(std::shared_ptr<dynamics::InertiaTerm> mass, double factor) {
  return std::make_shared<ScaledInertia>(std::move(mass), factor);
}

void add_to(loop::World& world, std::shared_ptr<dynamics::ForceTerm> term) {
  add_term(world, std::move(term));
}
void add_to(loop::World& world, std::shared_ptr<dynamics::InertiaTerm> mass) {
  add_term(world, std::move(mass));
}

}  // namespace palpate::validation
