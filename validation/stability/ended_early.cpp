#include "palpate/core/error.h"
#include "row.h"

namespace palpate::stability {

bool ended_early(const Column& column, const dynamics::StepResult& result, bool finite, bool interrupted,
                 bool grown, StabilityCell& cell) {
  if (interrupted || result.status == dynamics::StepStatus::kInterrupted) {
    cell.verdict = Verdict::kTooSlow;
  } else if (result.ok() && finite) {
    return false;
  } else if (result.ok()) {
    cell.verdict = Verdict::kNotFinite;
    cell.reason = "a state with a non-finite value was reported as valid";
  } else if (result.message.empty()) {
    cell.verdict = Verdict::kSilent;
    cell.reason = fmt::format("{} without a message", dynamics::to_string(result.status));
  } else if (grown && !(column.entry && is_explicit(column))) {
    cell.verdict = Verdict::kGrew;
    cell.reason = fmt::format("grew beyond all bounds, and then: {}", result.message);
  } else {
    cell.verdict = Verdict::kError;
    cell.reason = result.message;
  }
  return true;
}

void mark_wrong(const std::string& mistake, StabilityCell& cell) {
  if (mistake.empty()) return;
  cell.verdict = Verdict::kWrong;
  cell.reason = cell.reason.empty() ? mistake : fmt::format("{}: {}", mistake, cell.reason);
}

}  // namespace palpate::stability
