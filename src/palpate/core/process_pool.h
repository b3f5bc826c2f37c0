#pragma once
#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <list>
#include <string>

namespace palpate {

/// Runs pieces of work side by side, each in a process of its own: a crash or an endless loop in one touches
/// neither the others nor the caller.  All of them die with the caller's process.
///
/// The processes are not forked from the caller.  A fork copies the calling thread alone: locks that other
/// threads hold stay locked for ever, and libraries that count on threads of their own abort (OpenGL by
/// Mesa's software rasteriser does, at the first call in the child).  They are forked from a helper process
/// instead, which was itself forked from the caller before anything was opened, has one thread, and does
/// nothing else. The other way out, an exec of the program itself, was not taken: it would run the main() of
/// whoever links this library a second time (a main that does not know it would open its devices and windows
/// again, or start processes without end), and costs each piece of work the 12 ms that the libraries take to
/// load.
///
/// The helper is made by the first pool of a process, or by prepare().  It knows nothing that the caller does
/// later, therefore work is a plain function and its input is bytes; only the working folder is handed on.
class ProcessPool {
 public:
  /// Outcome of one piece of work.
  struct Outcome {
    enum class End { kDone, kError, kCrash, kOutOfTime };
    End end = End::kDone;
    /// the result of the work; the message of its exception; "killed by signal 11"; "out of time: 10 s"
    std::string bytes;
    int signal = 0;  ///< that ended the process; 0: none did
  };
  /// Runs in the child, on the bytes that start() was given.  `out_of_time` becomes true after the limit [CPU
  /// seconds]; the work should then return.  A function of the program, or of a library that was loaded
  /// before the helper was made (a lambda that captures nothing will do).
  using Work = std::string (*)(const std::string& bytes, const std::atomic<bool>& out_of_time);
  using Done = std::function<void(const Outcome&)>;

  /// Makes the helper now.  Programs that start threads or open a picture before their first pool call this
  /// at the start of main().  Costs a fork (1 ms); a second call does nothing.
  /// @throws Error where this process has more than one thread already: a helper would inherit their locks
  static void prepare();

  /// @throws Error where there is no helper, and it is too late to make one; see prepare()
  explicit ProcessPool(int jobs);
  ~ProcessPool();  ///< kills what still runs
  ProcessPool(const ProcessPool&) = delete;
  ProcessPool& operator=(const ProcessPool&) = delete;

  bool has_room() const { return static_cast<int>(children_.size()) < jobs_; }
  bool idle() const { return children_.empty(); }
  /// @param limit_s  CPU seconds until `out_of_time`.  Work that does not heed it is killed 2 s later; work
  ///   that sleeps, when it has used no CPU time for three times the limit and 5 s (a busy machine alone ends
  ///   nothing).
  /// @param done  is called by wait(), in the caller's process
  void start(Work work, const std::string& bytes, double limit_s, Done done);
  /// Returns after at least one piece has ended, or after `most_s`.
  void wait(double most_s);

 private:
  struct Child {
    std::uint64_t id;
    pid_t pid;
    int pipe;
    double limit_s, cpu_s, moved;  ///< CPU time at the last check; when that last grew, by the wall clock
    std::string bytes;
    bool ended, lost, killed;  ///< lost: its exit status can no longer be known
    int status;                ///< as waitpid() gives it, once it has ended
    Done done;
  };
  static bool is_asleep(Child& child);
  bool take_notice();  ///< one notice of the server's; false where the server is gone
  void finish(std::list<Child>::iterator child);
  int jobs_;
  int server_ = -1;  ///< socket to this pool's own server, a child of the helper
  std::uint64_t next_id_ = 1;
  std::list<Child> children_;
};

}  // namespace palpate
