#include "corners.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::render {
namespace {

/// Faces around each point, in compressed-row format.
struct FacesOfPoint {
  std::vector<int> begin, faces;
};

FacesOfPoint faces_of_point(const Surface& surface) {
  FacesOfPoint out;
  out.begin.assign(static_cast<std::size_t>(surface.points.cols()) + 1, 0);
  for (const int point : surface.faces.reshaped()) ++out.begin[static_cast<std::size_t>(point) + 1];
  for (std::size_t i = 1; i < out.begin.size(); ++i) out.begin[i] += out.begin[i - 1];
  out.faces.resize(static_cast<std::size_t>(surface.faces.size()));
  std::vector<int> next(out.begin.begin(), out.begin.end() - 1);
  for (int f = 0; f < surface.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k)
      out.faces[static_cast<std::size_t>(next[static_cast<std::size_t>(surface.faces(k, f))]++)] = f;
  return out;
}

/// Returns for each face its normal, scaled by twice the area.
Points face_vectors(const Surface& surface) {
  Points vectors(3, surface.faces.cols());
  for (int f = 0; f < surface.faces.cols(); ++f) {
    const Vec3 a = surface.points.col(surface.faces(0, f)), b = surface.points.col(surface.faces(1, f)),
               c = surface.points.col(surface.faces(2, f));
    vectors.col(f) = (b - a).cross(c - a);
  }
  return vectors;
}

float scaled(const Surface& surface, const ColourScale& scale, int point) {
  constexpr float kPlain = -10.0f;
  if (surface.values.size() == 0 || !std::isfinite(surface.values[point])) return kPlain;
  return static_cast<float>(share(scale, surface.values[point]));
}

}  // namespace

std::vector<Corner> corners(const Surface& surface, const ColourScale& scale, const Vec3& origin) {
  const FacesOfPoint around = faces_of_point(surface);
  const Points vectors = face_vectors(surface);
  const Points normals = vectors.colwise().normalized();
  const double least_cosine = std::cos(surface.crease_deg * std::numbers::pi / 180.0);
  std::vector<Corner> out;
  out.reserve(static_cast<std::size_t>(surface.faces.size()));
  for (int f = 0; f < surface.faces.cols(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int point = surface.faces(k, f);
      Vec3 sum = vectors.col(f);
      for (int i = around.begin[static_cast<std::size_t>(point)];
           i < around.begin[static_cast<std::size_t>(point) + 1]; ++i) {
        const int other = around.faces[static_cast<std::size_t>(i)];
        if (other != f && normals.col(other).dot(normals.col(f)) >= least_cosine) sum += vectors.col(other);
      }
      const Eigen::Vector3f p = (surface.points.col(point) - origin).cast<float>(),
                            n = sum.normalized().cast<float>();
      out.push_back({{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, scaled(surface, scale, point)});
    }
  }
  return out;
}

}  // namespace palpate::render
