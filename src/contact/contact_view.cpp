#include "contact/contact_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::contact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Box = AxisBox;

/// Makes all faces visible. Returns their bounds.
Box see_all(Patch& patch) {
  const auto count = static_cast<std::size_t>(patch.faces->cols());
  patch.visible.resize(count);
  patch.boxes.resize(count);
  Box bounds;
  for (std::size_t f = 0; f < count; ++f) {
    patch.visible[f] = static_cast<int>(f);
    patch.boxes[f] = box_of(patch, static_cast<int>(f));
    bounds.low = bounds.low.cwiseMin(patch.boxes[f].low);
    bounds.high = bounds.high.cwiseMax(patch.boxes[f].high);
  }
  return bounds;
}

/// Keeps the faces of `patch.visible` that reach into `window`. Returns their bounds. Branch-free compaction,
/// because the outcome is unpredictable: every face is written to the next place, which advances only if the
/// face is kept.
Box cut(Patch& patch, const Box& window) {
  Box bounds;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < patch.visible.size(); ++i) {
    const Box box = patch.boxes[i];
    bool keep = true;
    for (int k = 0; k < 3; ++k) keep &= (box.low[k] <= window.high[k]) & (box.high[k] >= window.low[k]);
    for (int k = 0; k < 3; ++k) {
      bounds.low[k] = std::min(bounds.low[k], keep ? box.low[k] : kInfinity);
      bounds.high[k] = std::max(bounds.high[k], keep ? box.high[k] : -kInfinity);
    }
    patch.boxes[kept] = box;
    patch.visible[kept] = patch.visible[i];
    kept += keep;
  }
  patch.visible.resize(kept);
  patch.boxes.resize(kept);
  return bounds;
}

}  // namespace

ContactAxes::ContactAxes(const Vec3& region_origin, const Vec3& normal) : origin(region_origin) {
  // Pixels are aligned with u and v. A reference direction far from the normal makes u and v rotate no faster
  // than the normal; one built from the normal's small components (Eigen's unitOrthogonal) spins where these
  // change sign.
  constexpr double kFar = 0.8;
  const Vec3 far_from_normal = std::abs(normal.x()) < kFar ? Vec3::UnitX() : Vec3::UnitY();
  to_world.col(2) = normal;
  to_world.col(0) = far_from_normal.cross(normal).normalized();
  to_world.col(1) = normal.cross(to_world.col(0));
}

ContactWindow fit_window(Patch& a, Patch& b, double candidate_gap) {
  Box box_a = see_all(a), box_b = see_all(b);
  constexpr int kCuts = 3;
  for (int i = 0; i < kCuts; ++i) {
    Box window_a, window_b;
    window_a.low = window_b.low = box_a.low.cwiseMax(box_b.low);
    window_a.high = window_b.high = box_a.high.cwiseMin(box_b.high);
    window_a.low.z() = -kInfinity;
    window_a.high.z() = box_b.high.z() + candidate_gap;
    window_b.low.z() = box_a.low.z() - candidate_gap;
    window_b.high.z() = kInfinity;
    box_a = cut(a, window_a);
    box_b = cut(b, window_b);
    if (!(box_a.low.x() <= box_a.high.x()) || !(box_b.low.x() <= box_b.high.x())) return {};
  }
  ContactWindow out;
  out.low = box_a.low.cwiseMax(box_b.low).head<2>();
  out.high = box_a.high.cwiseMin(box_b.high).head<2>();
  out.near = box_a.low.z() - candidate_gap;
  out.far = box_b.high.z() + candidate_gap;
  const double room = 1e-3 * (out.far - out.near);  // Margin at both ends of the depth range.
  out.near -= room;
  out.far += room;
  return out;
}

ContactCamera camera_of(const ContactWindow& window, double pixel, const Eigen::Vector2d& shift) {
  ContactCamera camera;
  if (window.is_empty()) return camera;
  const Eigen::Vector2d extent = window.high - window.low;
  camera.pixel = pixel;
  camera.u0 = window.low.x() - shift.x() * pixel;
  camera.v0 = window.low.y() - shift.y() * pixel;
  camera.width = std::max(1, static_cast<int>(std::ceil(extent.x() / pixel)) + 1);
  camera.height = std::max(1, static_cast<int>(std::ceil(extent.y() / pixel)) + 1);
  camera.near = window.near;
  camera.far = window.far;
  return camera;
}

ContactCamera camera_of(const ContactWindow& window, int pixels, const Eigen::Vector2d& shift) {
  ContactCamera camera = camera_of(window, window.longer_edge() / (pixels - 1), shift);
  camera.width = std::min(camera.width, pixels);  // Rounding of the edge.
  camera.height = std::min(camera.height, pixels);
  return camera;
}

ContactCamera fit_camera(Patch& a, Patch& b, double candidate_gap, int pixels, const Eigen::Vector2d& shift) {
  return camera_of(fit_window(a, b, candidate_gap), pixels, shift);
}

}  // namespace palpate::contact
