#pragma once
#include <memory>
#include <vector>

#include "palpate/dynamics/force_term.h"
#include "palpate/loop/world.h"

namespace palpate::python {

/// Forces on the nodes of one body that the caller sets between steps; they depend on neither state nor time.
class ExternalForces final : public dynamics::ForceTerm {
 public:
  /// @param block_id  block of the body  @param entries  number of its u-directions
  ExternalForces(int block_id, int entries) : block_id_(block_id), forces_(VecX::Zero(entries)) {}
  const VecX& forces() const { return forces_; }      ///< [N], x0 y0 z0 x1 ...
  void set(const VecX& forces) { forces_ = forces; }  ///< @pre the same size
  std::string_view name() const override { return "external forces"; }
  dynamics::TermTraits traits() const override;
  void add_force(const dynamics::StateView& state, VecX& f) override;
  void add_tangent(const dynamics::StateView&, double, double, dynamics::BorderedMatrix&) override {}
  void apply_tangent(const dynamics::StateView&, double, double, const VecX&, VecX&) override {}

 private:
  int block_id_;
  VecX forces_;
};

/// Adds such a term for each body, and makes the integrator anew. Called before the first step.
std::vector<std::shared_ptr<ExternalForces>> add_external_forces(loop::World& world);

}  // namespace palpate::python
