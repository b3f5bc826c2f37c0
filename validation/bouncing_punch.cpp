#include "bouncing_punch.h"

#include "b_bodies.h"
#include "faults.h"
#include "images.h"

namespace palpate::validation::punch {
namespace {

/// Fault "adhesive": Kelvin-Voigt pressure without the cut-off of its tensile part.
class Adhesive final : public DecoratedTerm {
 public:
  Adhesive(std::shared_ptr<dynamics::ForceTerm> term, double damping)
      : DecoratedTerm(std::move(term)), damping_(damping) {}
  void add_force(const dynamics::StateView& state, VecX& f) override {
    term().add_force(state, f);
    if (state.q[2] < 0.0) f[2] += std::min(0.0, -kArea * (kStiffness * state.q[2] + damping_ * state.u[2]));
  }

 private:
  double damping_;
};

/// Fault "drag": slight damping out of contact.
class Drag final : public DecoratedTerm {
 public:
  using DecoratedTerm::DecoratedTerm;
  void add_force(const dynamics::StateView& state, VecX& f) override {
    term().add_force(state, f);
    f[2] -= 1e-6 * kMass * state.u[2];
  }
};

}  // namespace

Bounce::Bounce(double height, const Law& asked, IntegratorSpec integrator, const std::string& fault) {
  dynamics::BlockSpec node;
  node.name = "punch";
  node.q_size = node.u_size = 3;
  node.q_scale = kSpeed / kOmega;
  node.u_scale = kSpeed;
  const int id = state.insert(node, Vec3(0.1, -0.2, height), Vec3(0, 0, -kSpeed));
  term->add_frame(contact::fixed_frame());
  ContactSpec law;
  law.stiffness_pa_m = kStiffness;
  law.damping_pa_s_m = 2.0 * asked.zeta * std::sqrt(kStiffness * kArea * kMass) / kArea;
  if (asked.hunt_crossley != (fault == "other-law")) {
    law.law = "hunt_crossley";
    law.hunt_crossley_s_m = 2.0 * asked.zeta / kSpeed;
  }
  auto source = make_punch_source(0, kArea, 4, 0);
  if (asked.stepped)
    source = spoiled(std::move(source), [](auto& samples) {
      double up = 0.0;
      for (auto& s : samples) {
        s.a.offset.z() += up;
        s.gap += up;
        up += 2e-4;
      }
    });
  if (fault == "half-area")
    source = spoiled(std::move(source), [](auto& samples) {
      for (auto& s : samples) s.area *= 0.5;
    });
  term->add_pair(std::move(source), law);
  if (fault == "adhesive")
    system.add(std::make_shared<Adhesive>(term, law.damping_pa_s_m));
  else if (fault == "drag")
    system.add(std::make_shared<Drag>(term));
  else
    system.add(std::static_pointer_cast<dynamics::ForceTerm>(term));
  if (fault == "half-damping") system.add(friction_defect(term, 0.5));
  system.add(std::make_shared<PointMass>(id, kMass));
  term->refresh(state.view());
  system.prepare(state.view());
  if (fault == "tolerance-ignored") integrator.rtol = 1e-3;
  if (fault == "first-order-rule" && integrator.name == "implicit-midpoint")
    integrator.name = "backward-euler";
  stepper = integrate::make_stepper(system, state, integrator);
}

}  // namespace palpate::validation::punch
