#pragma once
#include <vector>

#include "palpate/core/archive.h"
#include "palpate/loop/energy_balance.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

/// Integral over time by the trapezoidal rule, and by the same with steps twice as long: a third of their
/// difference estimates the error of the first (order 2).
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
  /// Between two periods.  What gives back takes the place of start().
  void archive(Archive& a);

 private:
  double contact_energy() const;
  double elastic_energy() const;
  /// What is dissipated now, and by which [W].
  struct Dissipation {
    double bodies = 0.0, contact = 0.0, coupling = 0.0;
  };
  Dissipation dissipation() const;
  void make_tools();
  void take_stored();

  World& world_;
  EnergyBalance balance_;
  double stored_at_start_ = 0.0, other_at_start_ = 0.0, contact_before_ = 0.0, elastic_before_ = 0.0;
  std::vector<PowerIntegral> hands_;
  PowerIntegral supports_, in_bodies_, in_contact_, in_coupling_;
};

}  // namespace palpate::loop
