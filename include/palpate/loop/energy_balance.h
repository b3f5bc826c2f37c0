#pragma once
#include <concepts>
#include <type_traits>

namespace palpate::loop {

/// Where the energy of a scene is, and where it came from and went since the start [J]:
///
///     stored now = stored at the start + hand + supports + queries + materials - dissipated + unaccounted.
///
/// `unaccounted` is what the integrator, the exchange between tool and bodies, and the quadrature in time of
/// the three powers leave: the error of this balance.
struct EnergyBalance {
  double time = 0.0;        ///< [s]
  double kinetic = 0.0;     ///< of bodies, bones and tools
  double elastic = 0.0;     ///< of the bodies' elements
  double contact = 0.0;     ///< of the contact's springs
  double other = 0.0;       ///< of the virtual coupling, of weight and of joints; zero at the start
  double hand = 0.0;        ///< work of hands on their couplings, from the start to the last tick
  double supports = 0.0;    ///< work of what moves held nodes along given paths
  double queries = 0.0;     ///< change of `contact` by queries, which change its samples at a state
  double materials = 0.0;   ///< change of `elastic` by changes of material, at a state
  double dissipated = 0.0;  ///< by the bodies' damping, contact, friction and coupling
  // of these:
  double kinetic_of_tools = 0.0;        ///< part of `kinetic`
  double coupling = 0.0;                ///< part of `other`: the springs of virtual couplings
  double dissipated_by_contact = 0.0;   ///< part of `dissipated`: its dampers and friction
  double dissipated_by_coupling = 0.0;  ///< part of `dissipated`; the rest are the bodies' own dampers
  double unaccounted = 0.0;             ///< see above
  /// error of the three works by their quadrature, from steps twice as long
  double quadrature_error = 0.0;

  /// Kinetic and potential energy now.
  double stored() const { return kinetic + elastic + contact + other; }
};

/// Visits the columns of energy.csv, with their units.
template <class F, class Balance>
requires(std::same_as<std::remove_const_t<Balance>, EnergyBalance>) constexpr void visit_energies(
    F&& f, Balance& b) {
  f("kinetic_j", b.kinetic);
  f("elastic_j", b.elastic);
  f("contact_j", b.contact);
  f("coupling_and_weight_j", b.other);
  f("work_of_hand_j", b.hand);
  f("work_of_supports_j", b.supports);
  f("changed_by_queries_j", b.queries);
  f("changed_by_materials_j", b.materials);
  f("dissipated_j", b.dissipated);
  f("unaccounted_j", b.unaccounted);
  f("quadrature_error_j", b.quadrature_error);
  f("kinetic_of_tools_j", b.kinetic_of_tools);
  f("coupling_j", b.coupling);
  f("dissipated_by_contact_j", b.dissipated_by_contact);
  f("dissipated_by_coupling_j", b.dissipated_by_coupling);
}

}  // namespace palpate::loop
