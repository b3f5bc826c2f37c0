#include "palpate/experiments/status.h"

#include <array>

namespace palpate::experiments {

const char* to_string(Status status) {
  static constexpr std::array<const char*, kStatuses> kNames = {
      "ok", "failed", "refused", "out of time", "crashed", "not tried", "missing"};
  return kNames[static_cast<std::size_t>(status)];
}

Status status_of(const std::string& name) {
  int i = 0;
  while (i + 1 < kStatuses && name != to_string(static_cast<Status>(i))) ++i;
  return static_cast<Status>(i);
}

}  // namespace palpate::experiments
