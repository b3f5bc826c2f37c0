#pragma once
#include <functional>
#include <memory>

#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/force_term.h"
#include "palpate/dynamics/inertia_term.h"
#include "palpate/loop/world.h"

/// Defects of the library, for the faults of cases. A case requests the same as without the fault, and a
/// decorator with one defect wraps a part of the library, so that the code path and the case's input are
/// unchanged.
namespace palpate::validation {

/// Forwards all calls that a step makes to a force term. Extensions beyond ForceTerm (fused steps, stored
/// tangents) are not forwarded, so that every integrator takes the general path. Nor is the slow part: the
/// case refreshes the contact itself.
class DecoratedTerm : public dynamics::ForceTerm {
 public:
  explicit DecoratedTerm(std::shared_ptr<dynamics::ForceTerm> term) : term_(std::move(term)) {}
  std::string_view name() const override { return term_->name(); }
  dynamics::TermTraits traits() const override { return term_->traits(); }
  void add_pattern(dynamics::PatternBuilder& pattern) const override { term_->add_pattern(pattern); }
  std::uint64_t pattern_version() const override { return term_->pattern_version(); }
  void add_force(const dynamics::StateView& state, VecX& f) override { term_->add_force(state, f); }
  void add_tangent(const dynamics::StateView& state, double k_scale, double d_scale,
                   dynamics::BorderedMatrix& A) override {
    term_->add_tangent(state, k_scale, d_scale, A);
  }
  void apply_tangent(const dynamics::StateView& state, double k_scale, double d_scale, const VecX& x,
                     VecX& y) override {
    term_->apply_tangent(state, k_scale, d_scale, x, y);
  }
  double energy(const dynamics::StateView& state) override { return term_->energy(state); }
  double dissipated_power(const dynamics::StateView& state) override {
    return term_->dissipated_power(state);
  }

 protected:
  dynamics::ForceTerm& term() const { return *term_; }

 private:
  std::shared_ptr<dynamics::ForceTerm> term_;
};

/// Factors of the parts of a term.
struct Shares {
  double force = 1.0;  ///< And its tangents.
  double energy = 1.0;
  double stiffness = 1.0, damping = 1.0;  ///< Factors of the tangents, relative to the force's.
};
/// Returns the term with its force, energy and tangents scaled.
std::shared_ptr<dynamics::ForceTerm> scaled(std::shared_ptr<dynamics::ForceTerm> term, const Shares& shares);

/// Returns elasticity without R: f = -K(X) (x - X), X the rest positions of the only node block.
std::shared_ptr<dynamics::ForceTerm> small_strain(std::shared_ptr<dynamics::ForceTerm> term, VecX rest);

/// Returns the term with additional stiffness damping that is not objective: f - beta K(X) v.
std::shared_ptr<dynamics::ForceTerm> with_rayleigh_damping(std::shared_ptr<dynamics::ForceTerm> term,
                                                           VecX rest, double beta);

/// Returns the error term of a contact's friction and damping, to be added to the contact, f(u) - f(0) being
/// correct. With `share` only this fraction of them acts; with `linear` they keep their slope at u = 0,
/// friction without its cap.
std::shared_ptr<dynamics::ForceTerm> friction_defect(std::shared_ptr<contact::ContactForce> contact,
                                                     double share, bool linear = false);

/// Returns the inertia scaled by a factor.
std::shared_ptr<dynamics::InertiaTerm> scaled(std::shared_ptr<dynamics::InertiaTerm> mass, double factor);

/// Changes the parts that an assembled scene computes with.
using Spoiler = std::function<void(loop::World& world)>;
/// Adds a force to an assembled scene, in the way assembly does.
void add_to(loop::World& world, std::shared_ptr<dynamics::ForceTerm> term);
void add_to(loop::World& world, std::shared_ptr<dynamics::InertiaTerm> mass);

}  // namespace palpate::validation
