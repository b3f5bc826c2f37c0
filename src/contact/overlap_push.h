#pragma once
#include <span>
#include <vector>

#include "contact/contact_view.h"
#include "contact/vertex_rule.h"

namespace palpate::contact {

/// What pixels push, and what of their volume the part across the normal was read from along either axis.
struct PixelPush {
  Vec3 sum = Vec3::Zero();                              ///< [m^3]
  Eigen::Vector2d read_from = Eigen::Vector2d::Zero();  ///< [m^3]

  void add(const PixelPush& other) {
    sum += other.sum;
    read_from += other.read_from;
  }
  /// The integral of the depth over the skin's area vectors [m^3].
  Vec3 integral() const;
};

/// The same of each pixel of an image, in the image's axes; derived in overlap_push.cpp.
class OverlapPush {
 public:
  /// @param hits  at the pixels, ascending; of a pixel with layers the deepest tells the slopes
  /// @param closer  by which the skins are taken to be closer than they are, less than the candidate gap [m]
  /// @returns  one a hit, zero where it does not press
  std::span<const PixelPush> find(std::span<const Hit> hits, const ContactCamera& camera,
                                  double candidate_gap, double closer = 0.0);

 private:
  void add_edge(std::span<const Hit> hits, int i, int j, int axis, double pixel);
  void add(std::size_t hit, int axis, double depth, double rise, double pixel);

  double candidate_gap_ = 0.0, closer_ = 0.0;
  std::vector<int> deepest_;  // by pixel, -1: none
  std::vector<PixelPush> push_;
};

}  // namespace palpate::contact
