#pragma once
#include <string>
#include <vector>

#include "cli/array_job.h"
#include "cli/program.h"
#include "cli/stability_options.h"

namespace palpate::cli {

struct ValidateArguments {
  std::vector<std::string> cases;  ///< Empty: all.
  bool slow = false;               ///< Also the slow cases, if no case is named.
  bool quick = false;              ///< Only the quick cases, if no case is named.
  int jobs = 0;                    ///< Cases run in parallel; 0: number of cores.
  bool inject_faults = false;      ///< Injects faults into the physics of each case: each must then fail.
  std::string folder;              ///< Folder for validation.json and report.html; empty: none are written.
  bool fresh = false;              ///< Discards the results of earlier calls in the folder.
  ArrayArguments array;
};
int validate(const ValidateArguments& arguments);

/// Runs the stability matrix, and prints and writes its verdicts.
int stability(const StabilityArguments& arguments);

/// Prints one line per case for `palpate list`: name, tab, summary.
int print_cases();

/// Parses the lines of `palpate validate` and of `palpate stability` without --haptic.
/// @throws Error for an invalid line
Invocation parse_validation(int argc, char** argv);

}  // namespace palpate::cli
