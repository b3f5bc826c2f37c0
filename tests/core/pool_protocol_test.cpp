// Protocol of the thread pool (src/core/workers.cpp), explored exhaustively: a caller that runs a few loops
// and then ends the pool, and helpers, each as a program of atomic steps; all interleavings are visited.
#include <array>
#include <cstdint>
#include <deque>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

constexpr int kLoops = 2, kMostTasks = 2, kMostThreads = 3;

/// Fault of the protocol that the exploration has to notice.
enum class Fault {
  kNone,
  kLooksBeforeItReadsWake,
  kWakesBeforeTheLoopOpens,
  kNumbersNoLoops,
  kStopsAfterWaking
};

struct Thread {
  int at = 0;    ///< next step
  int seen = 0;  ///< wake_ as read
  int loop = 0;  ///< ticket_ as read: number of the loop, ...
  int next = 0;  ///< ... next task
  int data = 0;  ///< number of the loop whose data were read
  bool asleep = false;
  auto operator<=>(const Thread&) const = default;
};

struct State {
  std::array<Thread, kMostThreads> threads;  ///< the first one is the caller
  int loop = 0, next = kMostTasks;           ///< ticket_; no task is left
  int data = 0, done = 0, wake = 0, loops = 0;
  bool stopping = false;
  std::array<std::array<int, kMostTasks>, kLoops + 1> runs{};
  auto operator<=>(const State&) const = default;
};

class Exploration {
 public:
  Exploration(int threads, Fault fault) : threads_(threads), fault_(fault) {}

  /// Returns a description of the first wrong state; empty if there is none.
  std::string wrong() {
    visit(State{});
    while (!open_.empty()) {
      const State state = open_.front();
      open_.pop_front();
      bool moved = false;
      for (int t = 0; t < threads_; ++t) moved |= step(state, t);
      if (!what_.empty()) return what_;
      if (!moved && !ended(state)) return "all threads wait";
    }
    return what_;
  }
  std::size_t states() const { return seen_.size(); }

 private:
  // Steps. A thread takes tasks in kReadTicket ... kCount and then continues at its own next step.
  enum At { kStart, kOpen, kWake, kReadTicket, kReadData, kTake, kRun, kCount, kWait, kSleep, kStop, kEnd };

  bool ended(const State& s) const {
    for (int t = 0; t < threads_; ++t)
      if (s.threads[static_cast<std::size_t>(t)].at != kEnd) return false;
    return true;
  }

  void visit(const State& s) {
    if (seen_.insert(s).second) open_.push_back(s);
  }

  static void wake_sleepers(State& s, bool caller) {
    for (std::size_t t = 0; t < kMostThreads; ++t)
      if ((t == 0) == caller) s.threads[t].asleep = false;
  }

  /// Advances one thread by one step; returns false if it cannot move.
  bool step(State s, int t) {
    Thread& me = s.threads[static_cast<std::size_t>(t)];
    if (me.asleep || me.at == kEnd) return false;
    if (!take_step(s, me, t == 0) && !(t == 0 ? call_step(s, me) : serve_step(s, me))) return false;
    visit(s);
    return true;
  }

  /// Pool::take().
  bool take_step(State& s, Thread& me, bool caller) {
    switch (me.at) {
      case kReadTicket:
        me.loop = s.loop;
        me.next = s.next;
        me.at = me.next < kMostTasks ? kReadData : kWait;
        return true;
      case kReadData:
        me.data = s.data;
        me.at = kTake;
        return true;
      case kTake:  // compare and exchange
        if (s.next == me.next && (s.loop == me.loop || fault_ == Fault::kNumbersNoLoops)) {
          ++s.next;
          me.at = kRun;
        } else {
          me.at = kReadTicket;
        }
        return true;
      case kRun:
        if (me.data != s.loops) what_ = "a task with the data of another loop";
        if (++s.runs[static_cast<std::size_t>(me.data)][static_cast<std::size_t>(me.next)] > 1)
          what_ = "a task runs twice";
        me.at = kCount;
        return true;
      case kCount:
        if (++s.done == kMostTasks) wake_sleepers(s, true);
        me.at = kReadTicket;
        return true;
      default: (void)caller; return false;
    }
  }

  /// Pool::share(), kLoops times, and Pool::stop().
  bool call_step(State& s, Thread& me) {
    const bool early = fault_ == Fault::kWakesBeforeTheLoopOpens;
    switch (me.at) {
      case kStart:
        if (s.loops == kLoops) {
          me.at = kStop;
          return true;
        }
        s.data = ++s.loops;  // nobody reads these two now, except to fail in kTake
        s.done = 0;
        me.at = early ? kWake : kOpen;
        return true;
      case kOpen:
        s.loop = s.loops;
        s.next = 0;
        me.at = early ? kReadTicket : kWake;
        return true;
      case kWake:
        ++s.wake;
        wake_sleepers(s, false);
        me.at = early ? kOpen : kReadTicket;
        return true;
      case kWait:  // polls, or is put to sleep by the kernel if done_ is as it was
        me.seen = s.done;
        me.at = me.seen == kMostTasks ? kStart : kSleep;
        if (me.seen == kMostTasks)
          for (const int runs : s.runs[static_cast<std::size_t>(s.loops)])
            if (runs != 1) what_ = "a loop ends before its tasks";
        return true;
      case kSleep:
        me.asleep = s.done == me.seen;
        me.at = kWait;
        return true;
      case kStop:
        if (fault_ == Fault::kStopsAfterWaking ? s.stopping || s.wake > kLoops : s.stopping) {
          s.stopping = true;
          if (fault_ != Fault::kStopsAfterWaking) {
            ++s.wake;
            wake_sleepers(s, false);
          }
          me.at = kEnd;
        } else if (fault_ == Fault::kStopsAfterWaking) {
          ++s.wake;
          wake_sleepers(s, false);
        } else {
          s.stopping = true;
        }
        return true;
      default: return false;
    }
  }

  /// Pool::serve().
  bool serve_step(State& s, Thread& me) {
    const bool late = fault_ == Fault::kLooksBeforeItReadsWake;
    switch (me.at) {
      case kStart:
        if (!late) me.seen = s.wake;
        me.at = kStop;
        return true;
      case kStop: me.at = s.stopping ? kEnd : kReadTicket; return true;
      case kWait:  // no task is left
        if (late) me.seen = s.wake;
        me.at = kSleep;
        return true;
      case kSleep:
        me.asleep = s.wake == me.seen;
        me.at = kStart;
        return true;
      default: return false;
    }
  }

  int threads_;
  Fault fault_;
  std::string what_;
  std::set<State> seen_;
  std::deque<State> open_;
};

}  // namespace

TEST(PoolProtocol, EndsWithEveryTaskRunOnce) {
  for (const int threads : {1, 2, 3}) {
    Exploration all(threads, Fault::kNone);
    EXPECT_EQ(all.wrong(), "") << threads;
    EXPECT_GT(all.states(), threads == 1 ? 15u : threads == 2 ? 500u : 10000u);
  }
}

TEST(PoolProtocol, NoticesFaults) {
  EXPECT_EQ(Exploration(2, Fault::kLooksBeforeItReadsWake).wrong(), "all threads wait");
  EXPECT_EQ(Exploration(2, Fault::kStopsAfterWaking).wrong(), "all threads wait");
  EXPECT_NE(Exploration(2, Fault::kNumbersNoLoops).wrong(), "");
}

// A helper that sleeps through a loop costs its help, not the loop's end.
TEST(PoolProtocol, WakingBeforeTheLoopOpensCostsHelpOnly) {
  EXPECT_EQ(Exploration(3, Fault::kWakesBeforeTheLoopOpens).wrong(), "");
}
