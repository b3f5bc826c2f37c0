#pragma once
#include "core/missing_outputs.h"

namespace palpate::cli {

/// Outputs that the help of a command promises and that this call could not deliver, while everything else
/// succeeded. The last line of the output and the exit status report them.
class MissingOutputs : public palpate::MissingOutputs {
 public:
  /// Prints the last line if an output is missing.
  /// @return `status`, or kExitIncomplete instead of 0
  int close(int status) const;
};

}  // namespace palpate::cli
