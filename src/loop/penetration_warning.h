#pragma once
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::loop {

/// Observer that logs a warning for each [[contact]] whose penetration becomes too deep for a penalty method
/// (PenetrationReport::too_deep), once per contact. At t = 0 it throws Error instead, with the depth and the
/// displacement that separates the two.
class PenetrationWarning : public Observer {
 public:
  void period(World& world, double t) override { check(world, t); }
  void queried(World& world, double t) override { check(world, t); }

 private:
  void check(const World& world, double t);
  /// Penetration per contact up to which nothing has to be computed [m]; infinite: warned
  std::vector<double> checked_to_;
};

}  // namespace palpate::loop
