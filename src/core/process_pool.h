#pragma once
#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <list>
#include <string>

#include "core/work_process.h"

namespace palpate {

/// Runs jobs in parallel, each in a separate process: a crash or an endless loop in one affects neither the
/// others nor the caller.  All of them are killed when the caller's process dies.
///
/// The processes are not forked from the caller.  A fork copies the calling thread only: locks that other
/// threads hold stay locked for ever, and libraries that rely on their threads abort (OpenGL by Mesa's
/// software rasteriser does, at the first call in the child).  They are forked from a helper process instead,
/// which was itself forked from the caller before any file was opened, has one thread, and does nothing else.
/// The alternative, an exec of the program itself, would run the main() of the program that links this
/// library a second time (a main unaware of it would open its devices and windows again, or start processes
/// without end), and costs 12 ms per job to load the libraries.
///
/// The helper is created by the first pool of a process, or by prepare().  It does not see later changes of
/// the caller's state, therefore a job is a plain function and its input is bytes; only the working folder is
/// passed on.
class ProcessPool {
 public:
  /// Outcome of one job.
  struct Outcome {
    enum class End { kDone, kError, kCrash, kOutOfTime, kNoMemory };
    End end = End::kDone;
    /// Result of the work; message of its exception; "killed by signal 11"; "out of time: 10 s";
    /// "not enough memory" (std::bad_alloc).
    std::string bytes;
    int signal = 0;  ///< Signal that ended the process; 0 for none.
  };
  /// Function that runs in the child process on the bytes given to start().  `out_of_time` becomes true after
  /// the limit [CPU seconds]; the work should then return.  It must be a function of the program, or of a
  /// library that was loaded before the helper was created (a lambda without captures is allowed).
  using Work = work_server::Work;
  /// Callback that receives the outcome, in the caller's process.
  using Done = std::function<void(const Outcome&)>;

  /// Creates the helper now.  Programs that start threads or open a picture before their first pool call this
  /// at the start of main().  Costs a fork (1 ms); a second call does nothing.
  /// @throws Error where this process already has more than one thread: the helper would inherit their locks
  static void prepare();

  /// Makes a pool that runs at most `jobs` processes at a time.
  /// @throws Error where there is no helper and it is too late to create one; see prepare()
  explicit ProcessPool(int jobs);
  ~ProcessPool();  ///< Kills the jobs that still run.
  ProcessPool(const ProcessPool&) = delete;
  ProcessPool& operator=(const ProcessPool&) = delete;

  bool has_room() const { return static_cast<int>(children_.size()) < jobs_; }
  bool idle() const { return children_.empty(); }
  /// Starts a job; has_room() must be true.
  /// @param limit_s  CPU seconds until `out_of_time`.  Work that ignores it is killed 2 s later; work that
  ///   sleeps is killed after three times the limit and 5 s without use of CPU time (a busy machine alone
  ///   ends nothing).
  /// @param done  called by wait(), in the caller's process
  void start(Work work, const std::string& bytes, double limit_s, Done done);
  /// Returns after at least one job has ended, or after `most_s` [s].
  void wait(double most_s);

 private:
  struct Child {
    std::uint64_t id;
    pid_t pid;
    int pipe;
    double limit_s, cpu_s, moved;  ///< CPU time at the last check, and the wall time when it last grew.
    std::string bytes;
    bool ended, lost, killed;  ///< lost: its exit status can no longer be known.
    int status;                ///< Status from waitpid(), once the process has ended.
    Done done;
  };
  static bool is_asleep(Child& child);
  bool take_notice();  ///< Receives one notice from the server; false where the server is gone.
  void finish(std::list<Child>::iterator child);
  int jobs_;
  int server_ = -1;  ///< Socket to this pool's server, a child of the helper.
  std::uint64_t next_id_ = 1;
  std::list<Child> children_;
};

}  // namespace palpate
