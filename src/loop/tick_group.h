#pragma once
#include <vector>

#include "tick_side.h"

namespace palpate::loop {

/// The hands whose tools meet each other, or one hand: the contact of their ticks is found together.
class TickGroup {
 public:
  /// One of the hands.
  struct Member {
    std::size_t hand;  ///< as scene::hands_of() counts them
    TickSide* ticks;
  };
  /// @param members  what they point to outlives this; where they share a RigidTouch, all of it, in its order
  explicit TickGroup(std::vector<Member> members);
  /// Returns one for each set of hands that meet, in the order of the first of each.
  /// @param hands  all of them, each with `ticks`; they outlive the groups
  template <class Hands>
  static std::vector<TickGroup> all(Hands& hands) {
    std::vector<Member> members;
    for (auto& hand : hands) members.push_back({members.size(), &hand.ticks});
    return of(members);
  }

  const std::vector<Member>& members() const { return members_; }
  /// Finds the contact of each in the tick of length h to t, with bodies, obstacles and each other.  Friction
  /// is that of the tick's end, found by repeated solves.
  /// @param record_of  returns the record that is in force for a hand
  template <class RecordOf>
  void find_contact(double t, double h, const RecordOf& record_of) {
    for (const Member& member : members_) member.ticks->begin_tick(t, h, record_of(member.hand));
    find(h);
  }
  /// @param i  counts members
  const dynamics::LinearisedContact& contact(std::size_t i) const { return found_[i]; }

 private:
  static std::vector<TickGroup> of(const std::vector<Member>& all);
  void find(double h);
  bool solve_and_improve(double h);

  std::vector<Member> members_;
  RigidTouch* rigid_;  ///< null where these tools meet bodies alone
  std::vector<dynamics::LinearisedContact> found_;
  std::vector<dynamics::RigidMotion> motions_;
  std::vector<tool::StepEquation> equations_;
};

}  // namespace palpate::loop
