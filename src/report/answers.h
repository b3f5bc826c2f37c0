#pragma once
#include <map>
#include <optional>
#include <vector>

#include "json.h"
#include "report/page.h"
#include "report/table.h"
#include "report/work_precision.h"

/// What each kind of result answers, in words: the first that a page says.
namespace palpate::report {

/// The warnings and verdicts of summary.json, as the command's standard output had them.
Answer remarks_answer(const Json& summary);
/// How a run ended, what it took, and what the hand felt.
Answer run_answer(const Json& summary, const std::optional<Table>& force);
/// When the force on the hand is largest [s]; NaN where there is none.
double time_of_peak_force(const Table& force);
/// Of each scene: which integrator is cheapest at each wanted error, for positions and for the force on the
/// hand.
std::vector<Answer> comparison_answers(const Table& compare,
                                       const std::map<std::string, ReferenceError>& references);
/// How far the force at the scene's own settings is from that of one system, and what would halve it.
Answer haptic_answer(const Table& haptic, const Json& summary);
/// How many tasks reached their end, and between what the figures lie.
Answer study_answer(const Table& study);
Answer validation_answer(const Json& validation);
Answer stability_answer(const Json& stability);
/// The fastest step of each size, and how many bars are met.
Answer bench_answer(const Json& bench);

}  // namespace palpate::report
