#pragma once
#include <vector>

#include "haptic_loop.h"

namespace palpate::loop {

/// Group of hands whose tools meet each other, or a single hand; the contact of their ticks is solved
/// together.
class TickGroup {
 public:
  /// One hand of the group.
  struct Member {
    std::size_t hand;  ///< In the numbering of scene::hands_of().
    HapticLoop* haptic_loop;
  };
  /// @param members  pointees must outlive the group; hands that share a RigidContactSolver are complete and
  /// in its order
  explicit TickGroup(std::vector<Member> members);
  /// Returns one group per set of hands that meet, ordered by the first hand of each.
  /// @param hands  all hands, each with a member `haptic_loop`; they must outlive the groups
  template <class Hands>
  static std::vector<TickGroup> all(Hands& hands) {
    std::vector<Member> members;
    for (auto& hand : hands) members.push_back({members.size(), &hand.haptic_loop});
    return of(members);
  }

  const std::vector<Member>& members() const { return members_; }
  /// Computes the contact of each member in the tick of length h that ends at t, with bodies, obstacles and
  /// each other. Friction is evaluated at the end of the tick, by repeated solves.
  /// @param record_of  returns the record in force for a hand
  template <class RecordOf>
  void find_contact(double t, double h, const RecordOf& record_of) {
    for (const Member& member : members_) member.haptic_loop->begin_tick(t, h, record_of(member.hand));
    find(h);
  }
  /// Returns the contact record of a member.  @param i  index of the member
  const dynamics::LinearisedContact& contact(std::size_t i) const { return found_[i]; }

 private:
  static std::vector<TickGroup> of(const std::vector<Member>& all);
  void find(double h);
  bool solve_and_improve(double h);

  std::vector<Member> members_;
  RigidContactSolver* rigid_;  ///< null if these tools contact only bodies
  std::vector<dynamics::LinearisedContact> found_;
  std::vector<dynamics::RigidMotion> motions_;
  std::vector<tool::StepEquation> equations_;
};

}  // namespace palpate::loop
