#pragma once
#include <string>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::cli {

/// Logs a warning for each [[contact]] whose overlap is too deep for a penalty, once, when it becomes so.
class OverlapWatch : public loop::Observer {
 public:
  void period(loop::World& world, double t) override { look(world, t); }
  void queried(loop::World& world, double t) override { look(world, t); }

 private:
  void look(const loop::World& world, double t);
  std::vector<double> most_;  ///< of each contact's overlap, infinite where it was said [m]
};

/// Lists remarks on a run, a line each: limits of its result, and events on the way.  Standard output prints
/// them, summary.json holds them, and the head of the page shows them from there.
std::vector<std::string> run_remarks(const loop::World& world, const loop::RunResult& result);

}  // namespace palpate::cli
