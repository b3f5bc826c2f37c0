#pragma once
#include <string>
#include <vector>

#include "report/run_report.h"

namespace palpate::cli {

/// Collects what a command's help promises and this call could not deliver, while all else was done.  The
/// last line names it, and so does the exit status.
class MissingOutputs {
 public:
  void add(const std::string& what, const std::string& why);
  /// Adds the figures that a page lacks.
  void add(const report::RunReport& report);
  bool empty() const { return things_.empty(); }
  /// Prints the last line where something is missing.  @return `status`, or kExitIncomplete instead of 0
  int close(int status) const;

 private:
  std::vector<std::string> things_;
};

}  // namespace palpate::cli
