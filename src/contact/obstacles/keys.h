#pragma once
#include <string>

#include "palpate/contact/obstacle.h"
#include "palpate/core/pose.h"
#include "palpate/mesh/spec.h"

/// Keys shared by several obstacles, and access to their values.
namespace palpate::contact {

inline PartKey position_key(const char* meaning) {
  return {.name = "position_m", .fallback = Vec3(Vec3::Zero()), .meaning = meaning};
}
inline PartKey rotation_key() {
  return {.name = "rotation_vector_rad",
          .fallback = Vec3(Vec3::Zero()),
          .meaning = "rotation from world axes to local axes: rotation axis times angle"};
}
inline PartKey length_key(const char* name, const char* meaning) {
  return {.name = name, .range = MeshRanges::length, .required = true, .fallback = 1.0, .meaning = meaning};
}

inline Vec3 position_of(const Settings& shape) { return std::get<Vec3>(shape.at("position_m")); }
inline double radius_of(const Settings& shape) { return std::get<double>(shape.at("radius_m")); }
inline Pose pose_of(const Settings& shape) {
  return {quaternion_of(std::get<Vec3>(shape.at("rotation_vector_rad"))), position_of(shape)};
}
inline TriMesh placed(TriMesh surface, const Settings& shape) {
  const Pose pose = pose_of(shape);
  for (Eigen::Index i = 0; i < surface.vertices.cols(); ++i)
    surface.vertices.col(i) = pose * Vec3(surface.vertices.col(i));
  return surface;
}

}  // namespace palpate::contact
