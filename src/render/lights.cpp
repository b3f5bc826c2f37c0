#include "lights.h"

namespace palpate::render {

Lights lights_of(const Camera& camera) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  Vec3 right = forward.cross(Vec3::UnitZ());
  right = right.norm() > 1e-6 ? Vec3(right.normalized()) : Vec3::UnitX();
  const Vec3 back = Vec3::UnitZ().cross(right).normalized() * -1.0;
  return {(1.0 * Vec3::UnitZ() - 0.55 * right + 0.45 * back).normalized(),
          (0.25 * Vec3::UnitZ() + 0.9 * right + 0.5 * back).normalized()};
}

Eigen::Matrix4d light_projection(const Vec3& key, double radius) {
  Camera light;
  light.eye = 3.0 * radius * key;
  light.target = Vec3::Zero();
  light.perspective = false;
  light.half_height = 1.05 * radius;
  light.near = 1.5 * radius;
  light.far = 6.0 * radius;
  return view_projection(light, 1.0);
}

}  // namespace palpate::render
