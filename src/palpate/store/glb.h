#pragma once
#include <string>
#include <vector>

#include "palpate/core/pose.h"
#include "palpate/store/surface_files.h"

namespace palpate::store {

/// One object of an animation: a deforming surface, or a rigid one that moves.
struct MovingSurface {
  std::string name;
  Faces faces;
  Rgb8 colour = {158, 168, 181};
  double opacity = 1.0;
  std::vector<Points> points;  ///< deforming: at each time, world [m]; rigid: once, in its own axes
  std::vector<Pose> poses;     ///< rigid: at each time; deforming: empty
};

/// Binary glTF 2.0 (Khronos 2021), one self-contained file, in metres and with y up.  A deforming surface is
/// a mesh at the first time with a morph target for each later one, in single precision; the weights go from
/// one target to the next, so that positions between two times are interpolated linearly.  A rigid surface is
/// a node with keyframes.  No normals: viewers shade such meshes by their faces, which stays right while they
/// deform.
/// @param times_s  strictly ascending; one: a mesh that stands still
/// @throws Error above the 4 GiB that the format can hold
std::string glb_of(const std::vector<MovingSurface>& surfaces, const std::vector<double>& times_s,
                   const std::string& title, const std::string& generator);

}  // namespace palpate::store
