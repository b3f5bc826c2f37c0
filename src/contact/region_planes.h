#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "palpate/core/types.h"

namespace palpate::contact {

/// From 0 to 1 as t is, without a kink: weights that let nothing come or go at once.
inline double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// The overlap of one proxy of a with one of b, seen along some normal.
struct PairOverlap {
  int a = 0, b = 0;          ///< proxies
  Vec3 push = Vec3::Zero();  ///< integral of the depth over the skin's area vectors, from b to a [m^3]
  double volume = 0.0;       ///< of the overlap, > 0 [m^3]
};

/// Normals of overlaps as smooth functions of them: derived in region_planes.cpp.
class RegionPlanes {
 public:
  /// @param overlaps  each pair of proxies once
  /// @param touch_a, touch_b  (p, q): whether two proxies of one body share skin, or are the same
  /// @returns  the normal of each of them
  template <class TouchA, class TouchB>
  std::span<const Vec3> find(std::span<const PairOverlap> overlaps, TouchA touch_a, TouchB touch_b) {
    overlaps_ = overlaps;
    edges_.clear();
    for (std::size_t i = 0; i < overlaps.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (touch_a(overlaps[i].a, overlaps[j].a) && touch_b(overlaps[i].b, overlaps[j].b))
          edges_.push_back({std::min(overlaps[i].volume, overlaps[j].volume), i, j});
    find_links();
    blend();
    return normals_;
  }

 private:
  struct Edge {
    double strength;
    std::size_t i, j;
  };
  void find_links();
  void join(std::size_t one, std::size_t other, double strength);
  void blend();

  std::span<const PairOverlap> overlaps_;
  std::vector<Vec3> normals_;
  std::vector<double> links_;      // by two overlaps
  std::vector<Edge> edges_;        // the strongest first
  std::vector<std::size_t> tree_;  // of a forest over the overlaps, the one that each is in
  std::vector<std::size_t> next_;  // overlap of the same tree, in a ring
};

}  // namespace palpate::contact
