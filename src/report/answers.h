#pragma once
#include <map>
#include <optional>
#include <vector>

#include "json.h"
#include "report/page.h"
#include "report/table.h"
#include "report/work_precision.h"

/// Answers of each kind of result in words, shown first on a page.
namespace palpate::report {

/// Returns the warnings and verdicts of summary.json, as the command printed them to standard output.
Answer remarks_answer(const Json& summary);
/// Summarises how a run ended, its cost, and the forces on the hand.
Answer run_answer(const Json& summary, const std::optional<Table>& force);
/// Returns the time of the largest force on the hand [s]; NaN if there is no force.
double time_of_peak_force(const Table& force);
/// Returns for each scene which integrator is cheapest at each target error, for positions and for the force
/// on the hand.
std::vector<Answer> comparison_answers(const Table& compare,
                                       const std::map<std::string, ReferenceError>& references);
/// Summarises the error of the force against the monolithic solution at the settings of the scene, and which
/// change would halve it.
Answer haptic_answer(const Table& haptic, const Json& summary);
/// Summarises how many tasks reached their end, and the range of the figures.
Answer study_answer(const Table& study);
/// Summarises how many cases passed, and which failed.
Answer validation_answer(const Json& validation);
/// Summarises the stability matrix.
Answer stability_answer(const Json& stability);
/// Summarises the fastest step of each size, and how many acceptance limits are met.
Answer bench_answer(const Json& bench);

}  // namespace palpate::report
