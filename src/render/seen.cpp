#include "render/seen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

// Visible share by orthographic depth images: a subject covers some pixels of a small image; where the
// nearest opaque surface is in front of the nearest point of the subject, it hides that pixel.  Both depths
// come from triangles sampled at the pixel centres; triangles outside the subjects' rectangle are skipped, so
// a view direction costs little more than rotating the points.
namespace palpate::render {
namespace {

constexpr int kPixels = 64;
constexpr double kEnough = 1.0 / 3.0, kWorthTurning = 1.5;
constexpr double kFar = -std::numeric_limits<double>::infinity();

/// Rectangle across the line of sight, with the depth nearest to the eye for each of its pixels.
class DepthImage {
 public:
  DepthImage(const Eigen::Vector2d& low, const Eigen::Vector2d& high)
      : low_(low), pixel_(std::max((high - low).maxCoeff() / kPixels, 1e-12)) {
    for (int a = 0; a < 2; ++a)
      size_[static_cast<std::size_t>(a)] =
          std::clamp(static_cast<int>(std::ceil((high - low)[a] / pixel_)), 1, kPixels);
    depth_.assign(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]), kFar);
  }

  /// Draws faces.  @param p  points in camera axes: right, up, towards the eye
  void draw(const Points& p, const Faces& faces) {
    for (Eigen::Index f = 0; f < faces.cols(); ++f)
      triangle(p.col(faces(0, f)), p.col(faces(1, f)), p.col(faces(2, f)));
  }
  const std::vector<double>& depth() const { return depth_; }

 private:
  /// Returns the range of pixels along an axis whose centres may lie between two coordinates.
  std::array<int, 2> range(int axis, double low, double high) const {
    const int last = size_[static_cast<std::size_t>(axis)] - 1;
    const double from = std::ceil((low - low_[axis]) / pixel_ - 0.5),
                 to = std::floor((high - low_[axis]) / pixel_ - 0.5);
    return {static_cast<int>(std::clamp(from, 0.0, last + 1.0)),
            static_cast<int>(std::clamp(to, -1.0, static_cast<double>(last)))};
  }

  void triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto [x0, x1] = range(0, std::min({a.x(), b.x(), c.x()}), std::max({a.x(), b.x(), c.x()}));
    const auto [y0, y1] = range(1, std::min({a.y(), b.y(), c.y()}), std::max({a.y(), b.y(), c.y()}));
    if (x0 > x1 || y0 > y1) return;
    const Eigen::Vector2d u = (b - a).head<2>(), v = (c - a).head<2>();
    const double area = u.x() * v.y() - u.y() * v.x();
    if (area == 0.0) return;
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const Eigen::Vector2d w = low_ + pixel_ * Eigen::Vector2d(x + 0.5, y + 0.5) - a.head<2>();
        const double s = (w.x() * v.y() - w.y() * v.x()) / area, t = (u.x() * w.y() - u.y() * w.x()) / area;
        if (s < 0.0 || t < 0.0 || s + t > 1.0) continue;
        double& depth = depth_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_[0]) +
                               static_cast<std::size_t>(x)];
        depth = std::max(depth, a.z() + s * (b.z() - a.z()) + t * (c.z() - a.z()));
      }
  }

  Eigen::Vector2d low_;
  double pixel_;
  std::array<int, 2> size_{};
  std::vector<double> depth_;
};

}  // namespace

double visible_share(const Scene& scene, const View& view) {
  const Mat3 axes = camera_axes(backwards_of(view), Vec3::UnitZ());
  std::vector<Points> turned;
  Eigen::AlignedBox2d box;
  for (const Surface& surface : scene.surfaces) {
    turned.emplace_back(axes.transpose() * surface.points);
    if (surface.subject)
      for (Eigen::Index i = 0; i < surface.points.cols(); ++i)
        box.extend(Eigen::Vector2d(turned.back().col(i).head<2>()));
  }
  if (box.isEmpty()) return 1.0;
  DepthImage subjects(box.min(), box.max()), others(box.min(), box.max());
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    const Surface& surface = scene.surfaces[i];
    if (surface.subject)
      subjects.draw(turned[i], surface.faces);
    else if (surface.opacity >= 1.0)
      others.draw(turned[i], surface.faces);
  }
  int covered = 0, seen = 0;
  for (std::size_t i = 0; i < subjects.depth().size(); ++i)
    if (subjects.depth()[i] > kFar) {
      ++covered;
      if (subjects.depth()[i] >= others.depth()[i]) ++seen;
    }
  return covered > 0 ? static_cast<double>(seen) / covered : 1.0;
}

ViewChoice::ViewChoice() {
  const View usual;
  views_.push_back(usual);
  for (const double elevation : {usual.elevation_deg, 50.0, -20.0})
    for (int turn = 0; turn < 8; ++turn) {
      View view = usual;
      view.azimuth_deg += 45.0 * turn;
      view.elevation_deg = elevation;
      views_.push_back(view);
    }
  seen_.assign(views_.size(), 0.0);
}

void ViewChoice::add(const Scene& instant) {
  for (std::size_t i = 0; i < views_.size(); ++i) seen_[i] += visible_share(instant, views_[i]);
  ++instants_;
}

View ViewChoice::best(bool from_below) const {
  std::size_t best = 0;
  for (std::size_t i = 1; i < views_.size(); ++i)
    if (seen_[i] > seen_[best] && (from_below || views_[i].elevation_deg >= 0.0)) best = i;
  const bool keep = seen_[0] > kEnough * instants_ || seen_[best] < kEnough * instants_ ||
                    seen_[best] < kWorthTurning * seen_[0];
  return views_[keep ? 0 : best];
}

}  // namespace palpate::render
