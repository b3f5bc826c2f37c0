#include "cell_runner.h"

#include "core/clock.h"
#include "palpate/core/error.h"

namespace palpate::stability {
namespace {

StabilityCell guarded(const Task& task, const CaseContext& context) {
  StabilityCell cell;
  Verdicts expected;
  try {
    expected = task.sub_case->expect(context);
    cell = task.sub_case->run(context);
  } catch (const Error& refusal) {
    cell.verdict = Verdict::kError;
    cell.reason = fmt::format("rejected: {}", refusal.what());
  } catch (const std::exception& mistake) {
    cell.verdict = Verdict::kSilent;
    cell.reason = fmt::format("internal error: {}", mistake.what());
  }
  cell.expected = expected;
  return cell;
}

}  // namespace

StabilityCell run_cell(const Task& task, int seeds, double limit_s, const std::atomic<bool>& expired) {
  const double start = cpu_seconds();
  StabilityCell cell = guarded(task, {*task.column, seeds, &expired});
  cell.row = task.row->name;
  cell.sub_case = task.sub_case->name;
  cell.integrator = task.column->label;
  cell.cpu_s = cpu_seconds() - start;
  if (cell.verdict == Verdict::kTooSlow && cell.reason.empty())
    cell.reason = fmt::format("cut off after {:g} s of CPU time", limit_s);
  return cell;
}

}  // namespace palpate::stability
