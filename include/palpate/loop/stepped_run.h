#pragma once
#include <memory>

#include "palpate/loop/run.h"

namespace palpate::loop {

/// A run in virtual time, a period at a time: for a caller that looks at the World in between.  All periods
/// together are run(), to the last bit.
class SteppedRun {
 public:
  /// Observers see the start.
  /// @param world  outlives this, and no other run goes through it
  /// @param options  as of run(); `real_time` has no meaning
  /// @throws Error for a duration that has more periods than can be counted
  SteppedRun(World& world, RunOptions options);
  /// No wrench on the hands any more.
  ~SteppedRun();
  SteppedRun(const SteppedRun&) = delete;
  SteppedRun& operator=(const SteppedRun&) = delete;

  /// Goes through one period (period_of()) on the World's own number of threads.  False where there is none:
  /// the end is reached, the integrator gave up, or `stop` was set, and result() says which.
  bool next();
  /// Of all periods so far.
  const RunResult& result() const;
  double duration() const;  ///< of all periods [s]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::loop
