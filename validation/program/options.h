#pragma once
#include <string>
#include <vector>

#include "cli/program.h"
#include "cli/stability_options.h"

namespace palpate::cli {

struct ValidateArguments {
  std::vector<std::string> cases;  ///< empty: all
  bool slow = false;               ///< also the slow cases, where no case is named
  bool quick = false;              ///< the quick cases alone, where no case is named
  int jobs = 0;                    ///< cases side by side; 0: as many as there are cores
  bool inject_faults = false;      ///< break the physics of each case on purpose: every one must then fail
  std::string folder;              ///< validation.json and report.html go here; empty: nowhere
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
