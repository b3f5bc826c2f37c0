#include "contact/coupled_nodes.h"

#include <algorithm>
#include <iterator>

namespace palpate::contact {

void CoupledNodes::take(std::span<const ContactSample> samples) {
  constexpr std::size_t kLargest = 2;
  met_.clear();
  const ContactSample* before = nullptr;
  for (const ContactSample& s : samples) {
    const bool same = before && s.a.count == before->a.count && s.b.count == before->b.count &&
                      s.a.node == before->a.node && s.b.node == before->b.node;
    before = &s;
    if (same) continue;  // the next pixel of the same two triangles
    for (int i = 0; i < s.a.count; ++i)
      for (int j = 0; j < s.b.count; ++j)
        met_.emplace_back(s.a.node[static_cast<std::size_t>(i)], s.b.node[static_cast<std::size_t>(j)]);
  }
  std::sort(met_.begin(), met_.end());
  met_.erase(std::unique(met_.begin(), met_.end()), met_.end());
  if (std::includes(pairs_.begin(), pairs_.end(), met_.begin(), met_.end())) return;
  both_.clear();
  std::set_union(pairs_.begin(), pairs_.end(), met_.begin(), met_.end(), std::back_inserter(both_));
  pairs_ = both_.size() > kLargest * met_.size() ? met_ : both_;
  ++version_;
}

void CoupledNodes::forget() {
  if (pairs_.empty()) return;
  pairs_.clear();
  ++version_;
}

void CoupledNodes::add_pattern(dynamics::PatternBuilder& pattern) const {
  for (const auto& [i, j] : pairs_) pattern.add_pair(i, j);
}

}  // namespace palpate::contact
