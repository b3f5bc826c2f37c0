#pragma once
#include <optional>

#include "figures.h"
#include "study/run.h"

namespace palpate::study {

/// Returns the content of a task's file: settings, machine and result.
/// @param result  "status", "reason", "figures", "times"
Json task_file(const Plan& plan, const Task& task, const Json& result);

/// Reads a task's file; empty where there is none, or it is no result of this task (after a disk failure):
/// the task is then run again.
std::optional<Json> read_task_file(const std::string& folder, const Task& task);

/// Whether a result is final: one that ran out of time is not where more time is now allowed.
bool is_final(const Plan& plan, const Json& file);

/// Returns the reason text, with the present limit: a task that exceeded a larger limit also exceeds a
/// smaller one.
std::string out_of_time_reason(const Plan& plan);

/// Quotes a word for a shell.
std::string quoted(const std::string& word);

}  // namespace palpate::study
