#include "cli/missing_outputs.h"

#include <fmt/format.h>

#include <cstdio>

#include "cli/stop.h"

namespace palpate::cli {

int MissingOutputs::close(int status) const {
  if (empty() || status == kExitStopped) return status;
  std::fflush(stdout);  // keeps the message the last line of both streams
  fmt::print(stderr, "palpate: incomplete: missing {}\n", fmt::join(outputs(), "; "));
  return status == 0 ? kExitIncomplete : status;
}

}  // namespace palpate::cli
