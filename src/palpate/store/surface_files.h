#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/core/types.h"

/// Surfaces at one instant as the files that modelling programs read.
namespace palpate::store {

using Rgb8 = std::array<std::uint8_t, 3>;  ///< red, green, blue as screens take them

/// One object of a picture or file.
struct SurfaceState {
  std::string name;
  Points points;              ///< world [m]
  Faces faces;                ///< indices into its own points
  VecX displacement;          ///< how far each point is from where it was at the start [m]
  VecX stress;                ///< von Mises, each point [Pa]
  std::vector<Rgb8> colours;  ///< one a point
};

/// Wavefront OBJ: an object a surface, positions in metres that read back exactly.
/// @param title  a comment at the top, one line
std::string obj_of(const std::vector<SurfaceState>& surfaces, const std::string& title);

/// Binary PLY of all surfaces as one mesh: x, y, z [m] (float), red, green, blue, displacement [m] and stress
/// [Pa] (float), and the number of the surface in `object` (int).
/// @param title  a comment at the top, one line
std::string ply_of(const std::vector<SurfaceState>& surfaces, const std::string& title);

}  // namespace palpate::store
