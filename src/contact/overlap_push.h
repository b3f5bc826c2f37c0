#pragma once
#include <span>
#include <vector>

#include "contact/contact_view.h"
#include "contact/vertex_rule.h"

namespace palpate::contact {

/// What the pixels of an image push: for each the integral of the depth over the skin's area vector, in the
/// image's axes [m^3]; derived in overlap_push.cpp.
class OverlapPush {
 public:
  /// @param hits  at the pixels, ascending; of a pixel with layers the deepest tells the slopes
  /// @returns  one a hit, zero where it does not press
  std::span<const Vec3> find(std::span<const Hit> hits, const ContactCamera& camera, double candidate_gap);

 private:
  void add_edge(std::span<const Hit> hits, int i, int j, int axis, double pixel, double candidate_gap);

  std::vector<int> deepest_;  // by pixel, -1: none
  std::vector<Vec3> push_;
};

}  // namespace palpate::contact
