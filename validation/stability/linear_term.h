#pragma once
#include "palpate/dynamics/force_term.h"

namespace palpate::stability {

/// f = -K (q + beta u) with a constant dense K over all nodes: exactly linear, so that rounding of rotations
/// does not hide the behaviour of an integrator.
class LinearTerm final : public dynamics::ForceTerm {
 public:
  LinearTerm(MatX K, double beta, bool contact) : K_(std::move(K)), beta_(beta), contact_(contact) {}
  std::string_view name() const override { return "linear body"; }
  dynamics::TermTraits traits() const override { return {.conservative = true, .contact = contact_}; }
  void add_pattern(dynamics::PatternBuilder& pattern) const override {
    for (int i = 0; i < nodes(); ++i)
      for (int j = 0; j < i; ++j) pattern.add_pair(i, j);
  }
  void add_force(const dynamics::StateView& state, VecX& f) override {
    f.noalias() -= K_ * (state.q + beta_ * state.u);
  }
  void add_tangent(const dynamics::StateView&, double k_scale, double d_scale,
                   dynamics::BorderedMatrix& A) override {
    for (int i = 0; i < nodes(); ++i)
      for (int j = 0; j < nodes(); ++j)
        A.body.add(A.body.slot(i, j), (k_scale + beta_ * d_scale) * K_.block<3, 3>(3 * i, 3 * j));
  }
  void apply_tangent(const dynamics::StateView&, double k_scale, double d_scale, const VecX& x,
                     VecX& y) override {
    y.noalias() += (k_scale + beta_ * d_scale) * (K_ * x);
  }
  double energy(const dynamics::StateView& state) override {
    const VecX e = state.q;
    return 0.5 * e.dot(K_ * e);
  }
  double dissipated_power(const dynamics::StateView& state) override {
    return beta_ * state.u.dot(K_ * state.u);
  }

 private:
  int nodes() const { return static_cast<int>(K_.rows() / 3); }
  MatX K_;
  double beta_;
  bool contact_;
};

/// Diagonal mass over one node block.
class DiagonalMass final : public dynamics::InertiaTerm {
 public:
  DiagonalMass(int block, VecX mass) : block_(block), mass_(std::move(mass)) {}
  int block_id() const override { return block_; }
  bool diagonal() const override { return true; }
  void add_mass(const dynamics::StateView&, double scale, dynamics::BorderedMatrix& A) const override {
    for (int i = 0; i < mass_.size() / 3; ++i)
      A.body.add(A.body.slot(i, i), Mat3(scale * mass_.segment<3>(3 * i).asDiagonal()));
  }
  void apply(const dynamics::StateView&, const VecX& x, VecX& y) const override {
    y += mass_.cwiseProduct(x);
  }

 private:
  int block_;
  VecX mass_;
};

}  // namespace palpate::stability
