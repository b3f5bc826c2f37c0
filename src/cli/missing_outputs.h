#pragma once
#include <string>
#include <vector>

#include "report/run_report.h"

namespace palpate::cli {

/// Outputs that the help of a command promises and that this call could not deliver, while everything else
/// succeeded. The last line of the output and the exit status report them.
class MissingOutputs {
 public:
  /// Adds a missing output `what` and the reason `why`.
  void add(const std::string& what, const std::string& why);
  /// Adds the figures that are missing from a page.
  void add(const report::RunReport& report);
  bool empty() const { return things_.empty(); }
  /// Prints the last line if an output is missing.
  /// @return `status`, or kExitIncomplete instead of 0
  int close(int status) const;

 private:
  std::vector<std::string> things_;
};

}  // namespace palpate::cli
