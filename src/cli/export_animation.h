#pragma once
#include <string>
#include <vector>

#include "recorded_surfaces.h"

namespace palpate::cli {

/// What a browser still opens at once.
inline constexpr int kMostKeyframes = 100;
inline constexpr std::size_t kMostPositionBytes = std::size_t{64} << 20;

struct Animation {
  std::string glb;         ///< the file
  std::vector<int> steps;  ///< that are in it
};

/// As many of these states as the limits above let pass, evenly spaced, the first and the last among them, as
/// an animation.  Bodies deform; tools and bones move as rigid bodies.
Animation animated(const store::RunReader& run, const RecordedSurfaces& surfaces,
                   const std::vector<int>& steps);

}  // namespace palpate::cli
