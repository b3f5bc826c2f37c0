#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "palpate/contact/sample.h"
#include "palpate/dynamics/matrix.h"

namespace palpate::contact {

/// Which nodes of one body the samples couple to which of another, or to others of its own: blocks of the
/// tangent that come and go with the contact.
///
/// A sample's gap moves with the nodes of both its points, so its K = A k n n^T couples each node of a with
/// each of b (tangent.cpp).  All nodes of one skin with all of the other would be a dense matrix: the pattern
/// holds what was met, and grows as contact slides on, so that it changes seldom (each change costs a
/// symbolic analysis); where it has become twice what is met now, it starts anew.
class CoupledNodes {
 public:
  void take(std::span<const ContactSample> samples);
  void forget();  ///< the nodes are counted otherwise from now on
  void add_pattern(dynamics::PatternBuilder& pattern) const;
  std::uint64_t version() const { return version_; }  ///< grows with every change

 private:
  std::vector<std::pair<int, int>> pairs_, met_, both_;  // ascending
  std::uint64_t version_ = 0;
};

}  // namespace palpate::contact
