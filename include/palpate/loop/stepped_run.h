#pragma once
#include <memory>

#include "palpate/loop/run.h"

namespace palpate::loop {

/// Run in virtual time that advances one period per call, for callers that access the World in between. All
/// periods together equal run(), bitwise.
class SteppedRun {
 public:
  /// Starts a run. Observers are called for the start.
  /// @param world  must outlive the run, and must not be used by another run meanwhile
  /// @param options  as for run(); `real_time` is ignored
  /// @throws Error for a duration with too many periods
  SteppedRun(World& world, RunOptions options);
  /// Resumes an archived run. Observers are not called for the start.
  /// @param world  assembled from the same scene, and not yet advanced
  /// @param options  options of the archived run  @param from  archive of that run
  /// @throws Error for an archive of another scene
  SteppedRun(World& world, RunOptions options, Archive& from);
  /// Sets the wrenches on the hands to zero.
  ~SteppedRun();
  SteppedRun(const SteppedRun&) = delete;
  SteppedRun& operator=(const SteppedRun&) = delete;

  /// Advances by one period (period_of()), with the World's number of threads. Returns false if there was no
  /// complete period: the end is reached, the integrator failed, or `stop` was set; see result().
  bool next();
  /// Returns the result of all periods so far.
  const RunResult& result() const;
  double duration() const;   ///< Duration of the run [s].
  double period() const;     ///< Length of each period but the last [s].
  int periods_done() const;  ///< Number of completed periods.
  int periods() const;       ///< Number of periods of the whole run.
  /// Writes the state for the resuming constructor. It makes one more contact query, so this run must not be
  /// continued.
  /// @pre the last next() completed its period, or next() was not called
  void archive(Archive& a);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::loop
