#pragma once
#include <optional>
#include <string>
#include <vector>

#include "experiments/engine.h"
#include "validation.h"

namespace palpate::cli {

/// One run of a case with a known answer.
struct CaseRun {
  const validation::ValidationCase* one;
  const validation::Fault* fault = nullptr;  ///< Null: no fault.
};

/// Result of a run.
struct CaseEnd {
  std::vector<validation::Measurement> measurements;
  double wall_s = 0.0;
  std::string broken;  ///< Reason for missing measurements: an exception's message, "killed by signal 11".

  void archive(Archive& a);
};

/// Results of all runs.
struct CaseEnds {
  std::vector<std::optional<CaseEnd>> ends;  ///< In the order of the runs; empty for those that did not end.
  experiments::EngineOutcome outcome;
};

/// Runs cases in parallel, each in a separate process (experiments/engine.h), the longest first.
CaseEnds run_cases(const std::vector<CaseRun>& runs, const experiments::Place& place,
                   const experiments::EngineOptions& options);

}  // namespace palpate::cli
