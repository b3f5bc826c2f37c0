#pragma once
#include <functional>
#include <memory>

#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/force_term.h"
#include "palpate/dynamics/inertia_term.h"
#include "palpate/loop/world.h"

/// The library with a defect.  A case asks the same of it, and what answers is a part of the library behind a
/// decorator that has one thing wrong: the code path, and the case's input, are those of the library as it
/// is.
namespace palpate::validation {

/// Forwards all that a force term is asked in a step; what a term is beside a ForceTerm (fused steps, stored
/// tangents) is lost, so that every integrator takes the general way.  Its slow part is not forwarded: the
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

/// How much of a term there is.
struct Shares {
  double force = 1.0;  ///< and with it its tangents
  double energy = 1.0;
  double stiffness = 1.0, damping = 1.0;  ///< of the tangents, over the force's
};
std::shared_ptr<dynamics::ForceTerm> scaled(std::shared_ptr<dynamics::ForceTerm> term, const Shares& shares);

/// Elasticity without R: f = -K(X) (x - X), X the rest positions of the only node block.
std::shared_ptr<dynamics::ForceTerm> small_strain(std::shared_ptr<dynamics::ForceTerm> term, VecX rest);

/// Stiffness damping that is not objective beside the term: f - beta K(X) v.
std::shared_ptr<dynamics::ForceTerm> with_rayleigh_damping(std::shared_ptr<dynamics::ForceTerm> term,
                                                           VecX rest, double beta);

/// Of a contact, what its friction and damping are off by, f(u) - f(0) being the right ones: with `share` of
/// them; with `linear` their slope at u = 0 for ever, friction without its cap.  Goes beside the contact.
std::shared_ptr<dynamics::ForceTerm> friction_defect(std::shared_ptr<contact::ContactForce> contact,
                                                     double share, bool linear = false);

std::shared_ptr<dynamics::InertiaTerm> scaled(std::shared_ptr<dynamics::InertiaTerm> mass, double factor);

/// Changes what an assembled scene computes with.
using Spoiler = std::function<void(loop::World& world)>;
/// Adds a force to an assembled scene, as assembling would have done.
void add_to(loop::World& world, std::shared_ptr<dynamics::ForceTerm> term);
void add_to(loop::World& world, std::shared_ptr<dynamics::InertiaTerm> mass);

}  // namespace palpate::validation
