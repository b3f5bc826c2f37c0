#include "contact/contact_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::contact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Bounds of the faces that are left.
struct Box {
  Vec3 low = Vec3::Constant(kInfinity), high = Vec3::Constant(-kInfinity);
};

Box face_box(const Patch& patch, int face) {
  const auto corner = [&](int k) { return patch.uvw.col((*patch.faces)(k, face)); };
  return {corner(0).cwiseMin(corner(1)).cwiseMin(corner(2)),
          corner(0).cwiseMax(corner(1)).cwiseMax(corner(2))};
}

/// The faces that are left, with their boxes.
struct Faced {
  std::vector<int> faces;
  std::vector<Box> boxes;
};

/// All of them; returns their bounds.
Box see_all(const Patch& patch, Faced& out) {
  const auto count = static_cast<std::size_t>(patch.faces->cols());
  out.faces.resize(count);
  out.boxes.resize(count);
  Box bounds;
  for (std::size_t f = 0; f < count; ++f) {
    out.faces[f] = static_cast<int>(f);
    out.boxes[f] = face_box(patch, static_cast<int>(f));
    bounds.low = bounds.low.cwiseMin(out.boxes[f].low);
    bounds.high = bounds.high.cwiseMax(out.boxes[f].high);
  }
  return bounds;
}

/// Keeps those that reach into `window`; returns their bounds.
Box cut(Faced& seen, const Box& window) {
  Box bounds;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < seen.faces.size(); ++i) {
    const Box box = seen.boxes[i];
    if ((box.low.array() > window.high.array()).any() || (box.high.array() < window.low.array()).any())
      continue;
    bounds.low = bounds.low.cwiseMin(box.low);
    bounds.high = bounds.high.cwiseMax(box.high);
    seen.boxes[kept] = box;
    seen.faces[kept++] = seen.faces[i];
  }
  seen.faces.resize(kept);
  seen.boxes.resize(kept);
  return bounds;
}

}  // namespace

ContactAxes::ContactAxes(const Vec3& region_origin, const Vec3& normal) : origin(region_origin) {
  to_world.col(2) = normal;
  to_world.col(0) = normal.unitOrthogonal();
  to_world.col(1) = normal.cross(to_world.col(0));
}

ContactWindow fit_window(Patch& a, Patch& b, double candidate_gap) {
  constexpr int kCuts = 3;
  thread_local Faced seen_a, seen_b;
  Box window;
  Box box_a = see_all(a, seen_a), box_b = see_all(b, seen_b);
  for (int i = 0; i < kCuts; ++i) {
    window.low = box_a.low.cwiseMax(box_b.low);
    window.high = box_a.high.cwiseMin(box_b.high);
    Box window_a = window, window_b = window;
    window_a.low.z() = -kInfinity;
    window_a.high.z() = box_b.high.z() + candidate_gap;
    window_b.low.z() = box_a.low.z() - candidate_gap;
    window_b.high.z() = kInfinity;
    box_a = cut(seen_a, window_a);
    box_b = cut(seen_b, window_b);
    if (seen_a.faces.empty() || seen_b.faces.empty()) break;
  }
  a.visible = seen_a.faces;
  b.visible = seen_b.faces;
  if (a.visible.empty() || b.visible.empty()) return {};
  ContactWindow out;
  out.low = box_a.low.cwiseMax(box_b.low).head<2>();
  out.high = box_a.high.cwiseMin(box_b.high).head<2>();
  out.near = box_a.low.z() - candidate_gap;
  out.far = box_b.high.z() + candidate_gap;
  const double room = 1e-3 * (out.far - out.near);  // nothing at the very ends of the depth range
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
  camera.width = std::min(camera.width, pixels);  // rounding of the edge
  camera.height = std::min(camera.height, pixels);
  return camera;
}

ContactCamera fit_camera(Patch& a, Patch& b, double candidate_gap, int pixels, const Eigen::Vector2d& shift) {
  return camera_of(fit_window(a, b, candidate_gap), pixels, shift);
}

}  // namespace palpate::contact
