#pragma once
#include <string>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::cli {

/// Observer that logs a warning for each [[contact]] whose penetration becomes too deep for a penalty method,
/// once per contact.
class OverlapWatch : public loop::Observer {
 public:
  void period(loop::World& world, double t) override { look(world, t); }
  void queried(loop::World& world, double t) override { look(world, t); }

 private:
  void look(const loop::World& world, double t);
  std::vector<double> most_;  ///< Largest penetration per contact [m]; infinite: warned
};

/// Returns remarks on a run, one line per remark: limits of its result, and events during the run. They are
/// printed to standard output and kept in summary.json, from which the head of the page shows them.
std::vector<std::string> run_remarks(const loop::World& world, const loop::RunResult& result);

}  // namespace palpate::cli
