#pragma once
#include <functional>
#include <string>

#include "model/tetrahedralise.h"

// CGAL, Qhull and GMP work on numbers that nobody saw before: a division by zero inside of them ends the
// process.  So a model is made in a child process, by a program that survives it, in a working folder that is
// gone: no core and no file of a library's own stays behind.
namespace palpate::cli {

struct WorkerEnd {
  int status = 0;      ///< exit status, if no signal ended it
  std::string signal;  ///< "Floating point exception", where a signal ended it; else empty
  std::string stage;   ///< that it was in
  std::string place;   ///< "at (0.1, 0, 0) m", where it worked last; may be empty
};

/// Runs `work` in a child process and waits for it.  SIGINT and SIGTERM go on to the child.
/// @throws Error where no process can be started
WorkerEnd run_worker(const std::function<int()>& work);

/// Runs `work` with what it may do, and once more without a stage of optimisation that it did not survive.
WorkerEnd run_attempts(model::Optimisation optimisation,
                       const std::function<int(const model::Optimisation&)>& work);

/// In the child: what it does now, for the WorkerEnd of one that does not survive it.
void worker_stage(const std::string& stage);
void worker_place(const std::string& place);

}  // namespace palpate::cli
