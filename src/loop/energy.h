#pragma once
#include <vector>

#include "palpate/core/archive.h"
#include "palpate/loop/energy_balance.h"
#include "palpate/loop/world.h"
#include "palpate/tool/tool.h"

namespace palpate::loop {

/// Time integral by the trapezoidal rule, and by the same rule with steps of twice the length; a third of
/// their difference estimates the error of the former (order 2).
class PowerIntegral {
 public:
  void start(double t, double power);
  void add(double t, double power);
  double value() const { return fine_; }
  double error() const;
  void archive(Archive& a);

 private:
  double t_ = 0.0, power_ = 0.0, t_coarse_ = 0.0, power_coarse_ = 0.0;
  double fine_ = 0.0, coarse_ = 0.0, at_coarse_ = 0.0;
  bool odd_ = false;
};

/// Energy balance of a run. The loop calls it at the start, after each tick and each period, and before and
/// after each contact query and each change of material.
class EnergyLedger {
 public:
  explicit EnergyLedger(World& world);
  void start();
  void before_query();
  void after_query();
  void before_material();
  void after_material();
  /// Adds the work of a hand over the tick that ends at t [s].
  /// @param hand  in the numbering of scene::hands_of()  @param on_hand  wrench on the hand  @param handle
  /// its twist
  void tick(std::size_t hand, double t, const Wrench& on_hand, const Twist& handle);
  /// Completes the balance at the end of a period, t [s].
  const EnergyBalance& period(double t);
  const EnergyBalance& balance() const { return balance_; }
  /// Writes or restores the state between two periods. Restoring replaces start().
  void archive(Archive& a);

 private:
  double contact_energy() const;
  double elastic_energy() const;
  /// Dissipated power by cause [W].
  struct Dissipation {
    double bodies = 0.0, contact = 0.0, coupling = 0.0;
  };
  Dissipation dissipation() const;
  void make_probes();
  void take_stored();

  World& world_;
  EnergyBalance balance_;
  double stored_at_start_ = 0.0, other_at_start_ = 0.0, contact_before_ = 0.0, elastic_before_ = 0.0;
  std::vector<tool::Tool> probes_;  ///< One per tool, for its energies at the State.
  std::vector<PowerIntegral> hands_;
  PowerIntegral supports_, in_bodies_, in_contact_, in_coupling_;
};

}  // namespace palpate::loop
