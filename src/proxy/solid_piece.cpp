#include "proxy/solid_piece.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::proxy {
namespace {

/// Returns the part of a polygon where side (x[axis] - at) >= 0, to within `flat`: Sutherland and Hodgman
/// (1974).
Polygon clipped(const Polygon& polygon, int axis, double at, double side, double flat) {
  Polygon out;
  out.face = polygon.face;
  out.is_cut = true;
  const auto add = [&out](const Vec3& corner) {
    PALPATE_CHECK(out.count < static_cast<int>(out.corner.size()),
                  "face {} has more than {} corners in a cell", out.face, out.corner.size());
    out.corner[static_cast<std::size_t>(out.count++)] = corner;
  };
  const auto height = [&](const Vec3& x) {
    return std::abs(x[axis] - at) <= flat ? 0.0 : side * (x[axis] - at);
  };
  for (int i = 0; i < polygon.count; ++i) {
    const Vec3 &p = polygon.corner[static_cast<std::size_t>(i)],
               &q = polygon.corner[static_cast<std::size_t>((i + 1) % polygon.count)];
    const double above_p = height(p), above_q = height(q);
    if (above_p >= 0.0) add(p);
    if (above_p * above_q < 0.0) add(p + above_p / (above_p - above_q) * (q - p));
  }
  return out;
}

double middle_of(const TriMesh& surface, int face, int axis) {
  const auto x = [&](int k) { return surface.vertices(axis, surface.faces(k, face)); };
  return (x(0) + x(1) + x(2)) / 3.0;
}

/// Whether the solid is below a face that is normal to the axis: it is where the face looks up.
bool solid_is_below(const TriMesh& surface, int face, int axis) {
  const auto x = [&](int k) { return surface.vertices.col(surface.faces(k, face)); };
  return Vec3(x(1) - x(0)).cross(Vec3(x(2) - x(0)))[axis] > 0.0;
}

}  // namespace

Vec3 Polygon::middle() const {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < count; ++i) sum += corner[static_cast<std::size_t>(i)];
  return sum / count;
}

Vec3 Polygon::area() const {
  Vec3 twice = Vec3::Zero();
  for (std::size_t i = 2; i < static_cast<std::size_t>(count); ++i)
    twice += (corner[i - 1] - corner[0]).cross(corner[i] - corner[0]);
  return 0.5 * twice;
}

SolidPiece whole_piece(const TriMesh& surface) {
  SolidPiece out;
  out.cell = {surface.vertices.rowwise().minCoeff(), surface.vertices.rowwise().maxCoeff()};
  for (int f = 0; f < static_cast<int>(surface.faces.cols()); ++f) {
    Polygon& polygon = out.surface.emplace_back();
    polygon.face = f;
    polygon.count = 3;
    for (int k = 0; k < 3; ++k)
      polygon.corner[static_cast<std::size_t>(k)] = surface.vertices.col(surface.faces(k, f));
    out.faces.push_back(f);
  }
  return out;
}

std::array<SolidPiece, 2> cut(const SolidPiece& piece, const TriMesh& surface, int axis, double at,
                              double flat) {
  std::array<SolidPiece, 2> out;
  auto& [below, above] = out;
  below.cell = above.cell = piece.cell;
  below.cell.high[axis] = above.cell.low[axis] = at;
  for (const Polygon& polygon : piece.surface) {
    double low = polygon.corner[0][axis], high = low;
    for (int i = 1; i < polygon.count; ++i) {
      low = std::min(low, polygon.corner[static_cast<std::size_t>(i)][axis]);
      high = std::max(high, polygon.corner[static_cast<std::size_t>(i)][axis]);
    }
    if (low >= at - flat && high <= at + flat)
      (solid_is_below(surface, polygon.face, axis) ? below : above).surface.push_back(polygon);
    else if (high <= at + flat)
      below.surface.push_back(polygon);
    else if (low >= at - flat)
      above.surface.push_back(polygon);
    else {
      below.surface.push_back(clipped(polygon, axis, at, -1.0, flat));
      above.surface.push_back(clipped(polygon, axis, at, 1.0, flat));
    }
  }
  for (const int f : piece.faces) {
    const double height = middle_of(surface, f, axis) - at;
    const bool is_below = std::abs(height) <= flat ? solid_is_below(surface, f, axis) : height < 0.0;
    (is_below ? below : above).faces.push_back(f);
  }
  return out;
}

// The covariance of a triangle's points about its middle m is (sum over corners of (x - m)(x - m)^T) / 12,
// times its area.
Mat3 principal_axes(const TriMesh& surface) {
  Mat3 second = Mat3::Zero();
  Vec3 first = Vec3::Zero();
  double area = 0.0;
  for (Eigen::Index f = 0; f < surface.faces.cols(); ++f) {
    Mat3 x;
    for (int k = 0; k < 3; ++k)
      x.col(k) = surface.vertices.col(surface.faces(k, f)) - surface.vertices.col(surface.faces(0, 0));
    const double a = 0.5 * (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm();
    const Vec3 m = x.rowwise().mean();
    const Mat3 arm = x.colwise() - m;
    second += a * (arm * arm.transpose() / 12.0 + m * m.transpose());
    first += a * m;
    area += a;
  }
  if (!(area > 0.0)) return Mat3::Identity();
  Mat3 axes = Eigen::SelfAdjointEigenSolver<Mat3>(second / area - (first / area) * (first / area).transpose())
                  .eigenvectors();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

}  // namespace palpate::proxy
