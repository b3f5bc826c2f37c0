#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

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
};

/// Runs cases in parallel, each in a separate process (core's ProcessPool), the longest first. Ends early and
/// kills the running cases if the user requests a stop.
/// @param progress receives the completed fraction, and the name of the case that ended last
/// @return one result per run, in the order of `runs`; empty for runs that had not ended
std::vector<std::optional<CaseEnd>> run_cases(
    const std::vector<CaseRun>& runs, int jobs,
    const std::function<void(double, const std::string&)>& progress);

/// Encodes a case's measurements as bytes, bitwise, and decodes them.
std::string bytes_of(const CaseEnd& end);
CaseEnd case_end_of(const std::string& bytes);

}  // namespace palpate::cli
