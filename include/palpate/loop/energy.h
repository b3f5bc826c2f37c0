#pragma once
#include <concepts>
#include <type_traits>
#include <vector>

#include "palpate/loop/world.h"

namespace palpate::loop {

/// Where the energy of a scene is, and where it came from and went since the start [J]:
///
///     stored now = stored at the start + hand + supports + queries + materials - dissipated + unaccounted.
///
/// `unaccounted` is what the integrator, the exchange between tool and bodies, and the quadrature in time of
/// the three powers leave: the error of this balance.
struct EnergyBalance {
  double time = 0.0;         ///< [s]
  double kinetic = 0.0;      ///< of bodies, bones and tools
  double elastic = 0.0;      ///< of the bodies' elements
  double contact = 0.0;      ///< of the contact's springs
  double other = 0.0;        ///< of the virtual coupling, of weight and of joints; zero at the start
  double hand = 0.0;         ///< work of hands on their couplings, from the start to the last tick
  double supports = 0.0;     ///< work of what moves held nodes along given paths
  double queries = 0.0;      ///< change of `contact` by queries, which change its samples at a state
  double materials = 0.0;    ///< change of `elastic` by changes of material, at a state
  double dissipated = 0.0;   ///< by the bodies' damping, contact, friction and coupling
  double unaccounted = 0.0;  ///< see above
  /// error of the three works by their quadrature, from steps twice as long
  double quadrature_error = 0.0;

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
}

/// Integral over time by the trapezoidal rule, and by the same with steps twice as long: a third of their
/// difference estimates the error of the first (order 2).
class PowerIntegral {
 public:
  void start(double t, double power);
  void add(double t, double power);
  double value() const { return fine_; }
  double error() const;

 private:
  double t_ = 0.0, power_ = 0.0, t_coarse_ = 0.0, power_coarse_ = 0.0;
  double fine_ = 0.0, coarse_ = 0.0, at_coarse_ = 0.0;
  bool odd_ = false;
};

/// Keeps the balance of a run: the loop calls it at its start, after each tick and each period, before and
/// after each query of contact and each change of material.
class EnergyLedger {
 public:
  explicit EnergyLedger(World& world);
  void start();
  void before_query();
  void after_query();
  void before_material();
  void after_material();
  /// @param hand  as scene::hands_of() counts them
  void tick(std::size_t hand, double t, const Wrench& on_hand, const Twist& handle);
  const EnergyBalance& period(double t);
  const EnergyBalance& balance() const { return balance_; }

 private:
  double contact_energy() const;
  double elastic_energy() const;
  double dissipated_power() const;
  void take_stored();

  World& world_;
  EnergyBalance balance_;
  double stored_at_start_ = 0.0, other_at_start_ = 0.0, contact_before_ = 0.0, elastic_before_ = 0.0;
  std::vector<PowerIntegral> hands_;
  PowerIntegral supports_, dissipated_;
};

}  // namespace palpate::loop
