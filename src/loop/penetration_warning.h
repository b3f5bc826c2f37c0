#pragma once
#include <vector>

#include "loop/penetration.h"
#include "palpate/loop/run.h"

namespace palpate::loop {

/// Observer that logs a warning for each [[contact]] whose penetration becomes too deep for a penalty method
/// (PenetrationReport::too_deep), once per contact. At t = 0 it throws Error instead, with the depth and the
/// displacement that separates the two.
class PenetrationWarning : public Observer {
 public:
  void period(World& world, double t) override { check(world, t); }
  void queried(World& world, double t) override { check(world, t); }

  /// Returns whether the start was rejected: nothing was simulated.
  bool rejected_start() const { return rejected_start_; }

 private:
  void check(const World& world, double t);
  [[noreturn]] void reject_start(const World& world, std::size_t contact, const PenetrationReport& report);
  /// Penetration per contact up to which nothing has to be computed [m]; infinite: warned
  std::vector<double> checked_to_;
  bool rejected_start_ = false;
};

}  // namespace palpate::loop
