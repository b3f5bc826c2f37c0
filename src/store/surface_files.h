#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/core/types.h"

/// Surfaces at one time, in the formats that modelling programs read.
namespace palpate::store {

using Rgb8 = std::array<std::uint8_t, 3>;  ///< Red, green, blue, sRGB.

/// Object of a picture or file.
struct SurfaceState {
  std::string name;
  Points points;              ///< World [m].
  Faces faces;                ///< Indices into this object's points.
  VecX displacement;          ///< Distance of each point from its initial position [m].
  VecX stress;                ///< Von Mises stress at each point [Pa].
  std::vector<Rgb8> colours;  ///< One per point.
};

/// Returns Wavefront OBJ: one object per surface, positions in metres that read back exactly.
/// @param title  comment at the top, one line
std::string obj_of(const std::vector<SurfaceState>& surfaces, const std::string& title);

/// Returns binary PLY of all surfaces as one mesh: x, y, z [m] (float), red, green, blue, displacement [m]
/// and stress [Pa] (float), and the index of the surface in `object` (int).
/// @param title  comment at the top, one line
std::string ply_of(const std::vector<SurfaceState>& surfaces, const std::string& title);

}  // namespace palpate::store
