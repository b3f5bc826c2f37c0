#pragma once
#include <concepts>
#include <type_traits>

namespace palpate::loop {

/// Energy balance of a scene since its start [J]:
///
///     stored now = stored at the start + hand + supports + queries + materials - dissipated + unaccounted.
///
/// `unaccounted` is the error of this balance: the residual of the integrator, the exchange between tool and
/// bodies, and the time quadrature of the powers.
struct EnergyBalance {
  double time = 0.0;        ///< Time of the balance [s].
  double kinetic = 0.0;     ///< Bodies, bones and tools.
  double elastic = 0.0;     ///< Elements of the bodies.
  double contact = 0.0;     ///< Springs of the contact.
  double other = 0.0;       ///< Virtual coupling, weight and joints; zero at the start.
  double hand = 0.0;        ///< Work of the hands on their couplings, up to the last tick.
  double supports = 0.0;    ///< Work of prescribed motions on the nodes they drive.
  double queries = 0.0;     ///< Change of `contact` by queries, which change its samples at a fixed state.
  double materials = 0.0;   ///< Change of `elastic` by material changes at a fixed state.
  double dissipated = 0.0;  ///< Damping of the bodies, contact, friction and coupling.
  // Parts of the above:
  double kinetic_of_tools = 0.0;        ///< Part of `kinetic`
  double coupling = 0.0;                ///< Part of `other`: springs of virtual couplings.
  double dissipated_by_contact = 0.0;   ///< Part of `dissipated`: dampers and friction of the contact.
  double dissipated_by_coupling = 0.0;  ///< Part of `dissipated`; the rest is damping of the bodies.
  double unaccounted = 0.0;             ///< Error of the balance, see above.
  /// Estimated quadrature error of the works and the dissipation, from steps of twice the length.
  double quadrature_error = 0.0;

  /// Returns the current kinetic and potential energy.
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
