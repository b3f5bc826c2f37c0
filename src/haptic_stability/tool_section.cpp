#include "tool_section.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

// The part of a closed surface below a plane and its cut with the plane bound a volume, whose area vectors
// sum to zero: the cut has the area -sum n . a over the parts of the faces below the plane. A face with
// corners at heights z0 <= z1 <= z2 has below z the share
//     (z - z0)^2/((z1 - z0)(z2 - z0))            up to z1,
//     1 - (z2 - z)^2/((z2 - z1)(z2 - z0))        beyond.
namespace palpate::haptic_stability {
namespace {

Vec3 area_vector(const TriMesh& surface, Eigen::Index face) {
  const auto corner = [&](Eigen::Index i) -> Vec3 { return surface.vertices.col(surface.faces(i, face)); };
  return 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
}

double share_below(Vec3 z, double height) {
  std::sort(z.begin(), z.end());
  if (height <= z[0]) return 0.0;
  if (height >= z[2]) return 1.0;
  const double below = height - z[0], above = z[2] - height, span = z[2] - z[0];
  return height < z[1] ? below * below / ((z[1] - z[0]) * span)
                       : 1.0 - above * above / ((z[2] - z[1]) * span);
}

struct Direction {
  Vec3 normal;
  double shadow;  ///< Projected area [m^2]: upper bound of the cuts normal to this direction
};

/// Returns the normals of the faces, in descending order of projected area; a normal within ten degrees of
/// the normal or opposite normal of a larger face is left out.
std::vector<Direction> face_directions(const TriMesh& surface) {
  std::vector<Vec3> areas;
  for (Eigen::Index i = 0; i < surface.faces.cols(); ++i) areas.push_back(area_vector(surface, i));
  std::vector<Vec3> sorted = areas;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Vec3& a, const Vec3& b) { return a.norm() > b.norm(); });
  const double alike = std::cos(std::numbers::pi / 18.0);
  std::vector<Direction> out;
  for (const Vec3& area : sorted) {
    if (!(area.norm() > 0.0)) break;
    const Vec3 n = area.normalized();
    if (std::any_of(out.begin(), out.end(),
                    [&](const Direction& d) { return std::abs(d.normal.dot(n)) > alike; }))
      continue;
    double shadow = 0.0;
    for (const Vec3& one : areas) shadow += 0.5 * std::abs(n.dot(one));
    out.push_back({n, shadow});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Direction& a, const Direction& b) { return a.shadow > b.shadow; });
  return out;
}

}  // namespace

double section_area(const TriMesh& surface, const Vec3& normal, double height) {
  double area = 0.0;
  for (Eigen::Index i = 0; i < surface.faces.cols(); ++i) {
    const auto z = [&](Eigen::Index corner) {
      return normal.dot(surface.vertices.col(surface.faces(corner, i)));
    };
    area -= share_below(Vec3(z(0), z(1), z(2)), height) * normal.dot(area_vector(surface, i));
  }
  return area;
}

double largest_section(const TriMesh& surface) {
  constexpr int kCuts = 33;  // odd, so that one cut goes through the middle
  double largest = 0.0;
  for (const Direction& direction : face_directions(surface)) {
    if (direction.shadow <= largest) break;
    const VecX heights = direction.normal.transpose() * surface.vertices;
    const double low = heights.minCoeff(), high = heights.maxCoeff();
    for (int cut = 0; cut < kCuts; ++cut) {
      const double height = low + (cut + 0.5) / kCuts * (high - low);
      largest = std::max(largest, section_area(surface, direction.normal, height));
    }
  }
  return largest;
}

}  // namespace palpate::haptic_stability
