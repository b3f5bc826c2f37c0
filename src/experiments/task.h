#pragma once
#include <string>

#include "core/process_pool.h"
#include "palpate/core/archive.h"
#include "palpate/experiments/status.h"
#include "store/result_db.h"

/// Experiments: many tasks, each in a separate process, whose results are stored and tabulated.
namespace palpate::experiments {

/// Result of a task.  Its process sets status, reason, cpu_s and bytes; the engine sets the rest.
struct Result {
  Status status = Status::kOk;
  std::string reason;      ///< Reason, where the status is not kOk.
  double cpu_s = 0.0;      ///< CPU time of the measured part [s].
  std::string bytes;       ///< Content, from archived().
  double limit_s = 0.0;    ///< Limit of the CPU time that the task had [s].
  store::Machine machine;  ///< Machine that made it, and when.

  /// Archives what a process returns.
  void archive(Archive& a) {
    a("status", status);
    a("reason", reason);
    a("cpu_s", cpu_s);
    a("bytes", bytes);
  }
};

/// One run to be made.
struct Task {
  std::string kind;  ///< Kind of work, for the database.
  std::string key;   ///< Hash of everything that determines the result; empty: it is not stored.
  std::string name;  ///< The task in words, or the command that runs it alone.
  /// Runs in the process of the task, on the bytes of Experiment::input().  @return an archived() Result
  ProcessPool::Work work = nullptr;
  double limit_s = 0.0;  ///< Limit of the CPU time [s].
  bool alone = false;    ///< Timed: no other task may run at the same time.
  int threads = 1;       ///< Number of threads that it uses.
};

}  // namespace palpate::experiments
