#pragma once
#include "palpate/render/camera.h"

namespace palpate::render {

/// Directions towards the two lights, fixed to the camera: the key from above and from the left, the fill low
/// and from the right.
struct Lights {
  Vec3 key, fill;
};
Lights lights_of(const Camera& camera);

/// World to clip coordinates as the key light sees a ball of `radius` about the origin: for the shadow map.
Eigen::Matrix4d light_projection(const Vec3& key, double radius);

}  // namespace palpate::render
