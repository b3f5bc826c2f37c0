#pragma once
#include <deque>
#include <optional>

#include "body_side.h"
#include "palpate/loop/contact_record.h"
#include "tick_group.h"

namespace palpate::loop {

/// Both sides in one thread, by turns: the order of everything is fixed, so that every run is the same to the
/// last bit.
class VirtualTime {
 public:
  /// Takes the hands at the start; observers see it.
  VirtualTime(World& world, BodySide& bodies, const RunOptions& options, RunResult& result);
  /// Goes on from where another one was archived, with a World that nothing has gone through; observers are
  /// told nothing.
  VirtualTime(World& world, BodySide& bodies, const RunOptions& options, RunResult& result, Archive& from);
  /// Goes through one period.  False where there is none, and where it was not gone through to its end.
  bool next();
  int periods() const { return periods_; }  ///< gone through
  /// After a period.  Only the constructor gives back.
  void archive(Archive& a);
  /// No wrench on the hands any more.
  void end();

 private:
  struct Coming {
    long tick;
    ContactRecord record;
  };
  struct Hand {
    Hand(const scene::Description& d, ToolSide& side) : tick_s(side.spec->tick_s), ticks(d, side) {}
    double tick_s;
    TickSide ticks;
    ContactRecord in_force;
    std::deque<Coming> coming;
    long count = 0;  ///< of ticks
  };

  void make_hands();
  void one_period(double t0, double t1);
  void tick_tools(double t0, double t1);
  void adopt(Hand& hand, const ContactRecord& record);
  /// The record in force at a hand's next tick.
  const ContactRecord& record_of(Hand& hand);
  void tick(TickGroup& group, double t, double h);

  World& world_;
  BodySide& bodies_;
  const RunOptions& options_;
  RunResult& result_;
  int periods_ = 0;  ///< gone through
  std::deque<Hand> hands_;
  std::vector<TickGroup> groups_;         ///< of hands_
  std::optional<MonolithicTicks> dense_;  ///< where tool and bodies are one system
};

}  // namespace palpate::loop
