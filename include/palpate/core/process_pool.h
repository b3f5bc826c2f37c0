#pragma once
#include <sys/types.h>

#include <atomic>
#include <functional>
#include <list>
#include <string>

namespace palpate {

/// Runs pieces of work side by side, each in a forked process of its own: a crash or an endless loop in one
/// touches neither the others nor the study.  The parent must have no other thread when it starts work (a
/// fork copies only the calling one).  A child dies with its parent.
class ProcessPool {
 public:
  /// What became of one piece of work.
  struct Outcome {
    enum class End { kDone, kError, kCrash, kOutOfTime };
    End end = End::kDone;
    /// what the work returned; the message of its exception; "killed by signal 11"; "out of time: 10 s"
    std::string bytes;
  };
  /// Runs in the child.  `out_of_time` becomes true after the limit [CPU seconds]; the work should then
  /// return.
  using Work = std::function<std::string(const std::atomic<bool>& out_of_time)>;
  using Done = std::function<void(const Outcome&)>;

  explicit ProcessPool(int jobs);
  ~ProcessPool();  ///< kills what still runs
  ProcessPool(const ProcessPool&) = delete;
  ProcessPool& operator=(const ProcessPool&) = delete;

  bool has_room() const { return static_cast<int>(children_.size()) < jobs_; }
  bool idle() const { return children_.empty(); }
  /// @param limit_s  CPU seconds until `out_of_time`.  Work that does not heed it is killed 2 s later; work
  ///   that sleeps, when it has used
  ///                 no CPU time for three times the limit and 5 s (a busy machine alone ends nothing).
  ///                 @param done  is called by wait(), in the parent
  void start(Work work, double limit_s, Done done);
  /// Returns after at least one piece has ended, or after `most_s`.
  void wait(double most_s);

 private:
  struct Child {
    pid_t pid;
    int pipe;
    double limit_s, cpu_s, moved;  ///< CPU time when last looked at; when that last grew, by the wall clock
    std::string bytes;
    bool killed;
    Done done;
  };
  static bool is_asleep(Child& child);
  void finish(std::list<Child>::iterator child);
  int jobs_;
  std::list<Child> children_;
};

}  // namespace palpate
