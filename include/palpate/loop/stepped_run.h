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
  /// Goes on from where another one was archived.  Observers see no start.
  /// @param world  assembled from the same scene, and nothing has gone through it
  /// @param options  those of the other one  @param from  what it kept
  /// @throws Error for an archive of another scene
  SteppedRun(World& world, RunOptions options, Archive& from);
  /// No wrench on the hands any more.
  ~SteppedRun();
  SteppedRun(const SteppedRun&) = delete;
  SteppedRun& operator=(const SteppedRun&) = delete;

  /// Goes through one period (period_of()) on the World's own number of threads.  False where there is none:
  /// the end is reached, the integrator gave up, or `stop` was set, and result() says which.
  bool next();
  /// Of all periods so far.
  const RunResult& result() const;
  double duration() const;   ///< of all periods [s]
  double period() const;     ///< length of each but the last [s]
  int periods_done() const;  ///< gone through
  int periods() const;       ///< of the whole run
  /// Keeps where it is, for the constructor above.  Queries contact once more: do not go on with this one.
  /// @pre the last next() went through its period, or none was called
  void archive(Archive& a);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::loop
