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

/// The overlap of one proxy of a, and the normal of the plane that it is to be seen along.
struct PlaneUnit {
  int proxy = 0;
  Vec3 push = Vec3::Zero();  ///< [m^3]
  double volume = 0.0;       ///< [m^3]
  Vec3 normal = Vec3::Zero();
};

/// Normals of overlaps as smooth functions of them: derived in region_planes.cpp.
class RegionPlanes {
 public:
  /// @param overlaps  each pair of proxies once, ascending by a
  /// @param touch_a, touch_b  (p, q): whether two proxies of one body share skin, or are the same
  /// @returns  the proxies of a, ascending
  template <class TouchA, class TouchB>
  std::span<const PlaneUnit> find(std::span<const PairOverlap> overlaps, TouchA touch_a, TouchB touch_b) {
    begin(overlaps);
    for (std::size_t i = 0; i < overlaps.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (unit_[i] != unit_[j] && touch_a(overlaps[i].a, overlaps[j].a) &&
            touch_b(overlaps[i].b, overlaps[j].b))
          add_touch(unit_[i], unit_[j], overlaps[i].volume * overlaps[j].volume);
    find_links();
    blend();
    return units_;
  }

 private:
  struct Edge {
    double strength;
    std::size_t i, j;
  };
  void begin(std::span<const PairOverlap> overlaps);
  void add_touch(std::size_t i, std::size_t j, double weight) { touch_[i * units_.size() + j] += weight; }
  void find_links();
  void blend();
  std::size_t root(std::size_t i);

  std::vector<PlaneUnit> units_;
  std::vector<std::size_t> unit_;      // by overlap
  std::vector<double> touch_, links_;  // by pair of units, the first where i > j
  std::vector<Edge> edges_;            // the strongest first
  std::vector<std::size_t> parent_;    // of a forest over the units
};

}  // namespace palpate::contact
