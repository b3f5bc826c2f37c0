#include "tick_group.h"

#include <Eigen/LU>
#include <algorithm>

namespace palpate::loop {

TickGroup::TickGroup(std::vector<Member> members)
    : members_(std::move(members)),
      rigid_(members_.front().haptic_loop->partitioned_tool().rigid_contact.get()),
      found_(members_.size()),
      equations_(members_.size()) {}

std::vector<TickGroup> TickGroup::of(const std::vector<Member>& all) {
  std::vector<std::vector<Member>> sets;
  for (const Member& member : all) {
    const auto& rigid = member.haptic_loop->partitioned_tool().rigid_contact;
    const auto set = std::find_if(sets.begin(), sets.end(), [&](const auto& others) {
      return rigid && others.front().haptic_loop->partitioned_tool().rigid_contact == rigid;
    });
    (set == sets.end() ? sets.emplace_back() : *set).push_back(member);
  }
  std::vector<TickGroup> out;
  for (auto& set : sets) out.emplace_back(std::move(set));
  return out;
}

// Friction of a tick is evaluated at its end (contact/friction.h), which is predicted by a linearly implicit
// step of the tools under the records; the scheme of each tool then uses the resulting record. The motion of
// the other tools within the tick is treated the same way.
void TickGroup::find(double h) {
  bool has_friction = false;
  motions_.clear();
  for (const Member& member : members_) {
    has_friction = has_friction || member.haptic_loop->has_friction();
    const tool::Tool& tool = member.haptic_loop->partitioned_tool().tool;
    motions_.push_back({tool.pose(), tool.twist()});
  }
  if (rigid_) rigid_->begin_tick(members_.front().haptic_loop->partitioned_tool().tool.time(), motions_);
  const bool touches = rigid_ && rigid_->touches();
  if (has_friction || (touches && (rigid_->has_friction() || members_.size() > 1)))
    while (!solve_and_improve(h)) {
      // All contacts are linearised about the same guess of the end.
      for (const Member& member : members_) member.haptic_loop->relinearise();
      if (touches) rigid_->relinearise();
    }
  for (std::size_t i = 0; i < members_.size(); ++i) {
    found_[i] = members_[i].haptic_loop->contact_with_bodies();
    if (touches) found_[i] = rigid_->with(static_cast<int>(i), found_[i]);
  }
  if (rigid_) rigid_->end_tick();
}

bool TickGroup::solve_and_improve(double h) {
  const bool touches = rigid_ && rigid_->touches();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const dynamics::LinearisedContact& of_bodies = members_[i].haptic_loop->contact_with_bodies();
    equations_[i] = members_[i].haptic_loop->equation(
        h, touches ? rigid_->about_now(static_cast<int>(i), of_bodies) : of_bodies);
  }
  if (touches) rigid_->solve(h, equations_);
  bool done = !touches || rigid_->update_friction();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const Vec6 change = touches ? rigid_->change(static_cast<int>(i))
                                : Vec6(equations_[i].A.partialPivLu().solve(equations_[i].r));
    done = members_[i].haptic_loop->update_friction(h, change) && done;
  }
  return done;
}

}  // namespace palpate::loop
