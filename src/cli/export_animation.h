#pragma once
#include <string>
#include <vector>

#include "recorded_surfaces.h"

namespace palpate::cli {

/// Limits of an animation that a browser can open at once: states, and bytes of positions.
inline constexpr int kMostKeyframes = 100;
inline constexpr std::size_t kMostPositionBytes = std::size_t{64} << 20;

/// Animation as a binary glTF file.
struct Animation {
  std::string glb;         ///< Content of the file
  std::vector<int> steps;  ///< States in the file
};

/// Returns an animation of these states, thinned to the limits above: evenly spaced, the first and the last
/// among them. Bodies deform; tools and bones move as rigid bodies.
Animation animated(const store::RunReader& run, const RecordedSurfaces& surfaces,
                   const std::vector<int>& steps);

}  // namespace palpate::cli
