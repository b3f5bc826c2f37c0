#pragma once
#include <functional>
#include <string>

#include "model/tetrahedralise.h"

// CGAL, Qhull and GMP operate on arbitrary input: a division by zero inside them ends the process. A model is
// therefore built in a child process whose parent survives, in a working folder that is removed: neither a
// core file nor a temporary file of a library remains.
namespace palpate::cli {

/// How a child process ended.
struct WorkerEnd {
  int status = 0;      ///< Exit status, if no signal ended the process
  std::string signal;  ///< Signal that ended the process, as "Floating point exception"; else empty
  std::string stage;   ///< Last stage
  std::string place;   ///< Last location, as "at (0.1, 0, 0) m"; may be empty
};

/// Runs `work` in a child process and waits for it. SIGINT and SIGTERM are forwarded to the child.
/// @throws Error if no process can be started
WorkerEnd run_worker(const std::function<int()>& work);

/// Runs `work` with all permitted stages of optimisation; if a stage ends the process by a signal, runs it
/// again without that stage.
WorkerEnd run_attempts(model::Optimisation optimisation,
                       const std::function<int(const model::Optimisation&)>& work);

/// Record the current stage and location in the child process, for the WorkerEnd of a process that a signal
/// ends.
void worker_stage(const std::string& stage);
void worker_place(const std::string& place);

}  // namespace palpate::cli
