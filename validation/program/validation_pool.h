#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "validation.h"

namespace palpate::cli {

/// A case with a known answer, to be run once.
struct CaseRun {
  const validation::ValidationCase* one;
  const validation::Fault* fault = nullptr;  ///< null: the library as it is
};

/// What became of it.
struct CaseEnd {
  std::vector<validation::Measurement> measurements;
  double wall_s = 0.0;
  std::string broken;  ///< why nothing was measured: an exception's message, "killed by signal 11"
};

/// Runs cases side by side, each in a process of its own (core's ProcessPool), the longest first.  Ends early
/// where the user wants to stop, and kills what still runs.
/// @param progress  told the share that is done, and what ended last
/// @return one each, in the order of `runs`; empty where it had not ended
std::vector<std::optional<CaseEnd>> run_cases(
    const std::vector<CaseRun>& runs, int jobs,
    const std::function<void(double, const std::string&)>& progress);

/// A case's measurements as bytes, bit for bit, and back.
std::string bytes_of(const CaseEnd& end);
CaseEnd case_end_of(const std::string& bytes);

}  // namespace palpate::cli
