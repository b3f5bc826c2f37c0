#pragma once
#include <string>
#include <vector>

#include "palpate/report/run_report.h"

namespace palpate::cli {

/// What a command's help promises and this call could not do, while all else was done: told in the last line,
/// and by the exit status.
class Undelivered {
 public:
  void add(const std::string& what, const std::string& why);
  /// The figures that a page lacks.
  void add(const report::RunReport& report);
  bool empty() const { return things_.empty(); }
  /// Prints the last line where something is missing.  @return `status`, or kExitIncomplete in the place of 0
  int close(int status) const;

 private:
  std::vector<std::string> things_;
};

}  // namespace palpate::cli
