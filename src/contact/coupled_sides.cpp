#include "contact/coupled_sides.h"

namespace palpate::contact {

void CoupledSides::take(std::span<const CoupledNodes::Joint> joints) {
  if (const std::uint64_t now = sides_version(); now != counted_ || neighbours_[0].empty()) {
    neighbours_ = {a_.soft()->neighbours(), b_.soft()->neighbours()};
    coupled_.start(neighbours_[0], neighbours_[1]);
    counted_ = now;
  }
  coupled_.take(joints);
}

void CoupledSides::add_pattern(dynamics::PatternBuilder& pattern) const {
  if (a_.soft()) a_.soft()->add_face_pattern(pattern);
  if (b_.soft() && &b_ != &a_) b_.soft()->add_face_pattern(pattern);
  coupled_.add_pattern(pattern);
}

std::uint64_t CoupledSides::sides_version() const {
  std::uint64_t sum = a_.soft() ? a_.soft()->pattern_version() : 0;
  if (b_.soft() && &b_ != &a_) sum += b_.soft()->pattern_version();
  return sum;
}

// Both counters increase only.
std::uint64_t CoupledSides::version() const { return sides_version() + coupled_.version(); }

}  // namespace palpate::contact
