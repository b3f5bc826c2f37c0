#pragma once
#include "render/camera.h"

namespace palpate::render {

/// Directions towards the two lights, fixed to the camera: the key light from above left, the fill light low
/// from the right.
struct Lights {
  Vec3 key, fill;
};
Lights lights_of(const Camera& camera);

/// Returns the matrix from world to clip coordinates of the key light for a ball of `radius` about the
/// origin, for the shadow map.
Eigen::Matrix4d light_projection(const Vec3& key, double radius);

}  // namespace palpate::render
