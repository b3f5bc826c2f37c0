#pragma once
#include <optional>

#include "figures.h"
#include "palpate/study/run.h"

namespace palpate::study {

/// The file of a task: what was run, where, and what came of it.
/// @param result  "status", "reason", "figures", "times"
Json task_file(const Plan& plan, const Task& task, const Json& result);

/// Reads it; nothing where there is none, or it is no result of this task (a disk that lost it): the task is
/// then run again.
std::optional<Json> read_task_file(const std::string& folder, const Task& task);

/// Whether a result stays: one that ran out of time does not where more time is now allowed.
bool is_final(const Plan& plan, const Json& file);

/// Of the limit as it is now: a task that had more and did not end in it does not end in less.
std::string out_of_time_reason(const Plan& plan);

/// A word of a command line, quoted for a shell.
std::string quoted(const std::string& word);

}  // namespace palpate::study
