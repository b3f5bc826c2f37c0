#pragma once
#include <string>
#include <vector>

#include "palpate/core/pose.h"
#include "store/surface_files.h"

namespace palpate::store {

/// Object of an animation: a deforming surface, or a moving rigid one.
struct MovingSurface {
  std::string name;
  Faces faces;
  Rgb8 colour = {158, 168, 181};
  double opacity = 1.0;
  std::vector<Points> points;  ///< Deforming: positions at each time, world [m]; rigid: once, body axes [m].
  std::vector<Pose> poses;     ///< Rigid: pose at each time; deforming: empty.
};

/// Returns binary glTF 2.0 (Khronos 2021), one self-contained file, in metres and with y up.  A deforming
/// surface is a mesh at the first time with one morph target per later time, in single precision; the weights
/// move from one target to the next, so that positions are interpolated linearly in time.  A rigid surface is
/// a node with keyframes.  Normals are left out: viewers then use flat shading, which stays correct under
/// deformation.
/// @param times_s  strictly ascending [s]; a single time gives a static mesh
/// @throws Error above the 4 GiB that the format can hold
std::string glb_of(const std::vector<MovingSurface>& surfaces, const std::vector<double>& times_s,
                   const std::string& title, const std::string& generator);

}  // namespace palpate::store
