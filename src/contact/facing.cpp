#include "contact/facing.h"

#include <cmath>

#include "palpate/core/counters.h"

namespace palpate::contact {
namespace {

/// Barycentric coordinates of (u, v) in the projected triangle: false when it is seen edge-on, or (u, v) lies
/// outside by more than the rasteriser's sub-pixel grid explains (a quarter of the triangle), where the plane
/// would be extrapolated too far.
bool barycentric(const Patch& patch, int face, double u, double v, Vec3& weights) {
  constexpr double kOutside = -0.25, kFlat = 1e-12;
  const auto corner = [&](int k) { return patch.uvw.col((*patch.faces)(k, face)); };
  const double ax = corner(0).x() - u, ay = corner(0).y() - v, bx = corner(1).x() - u, by = corner(1).y() - v,
               cx = corner(2).x() - u, cy = corner(2).y() - v;
  const Vec3 twice_areas(bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx);
  const double sum = twice_areas.sum();
  const double size = (corner(1) - corner(0)).squaredNorm() + (corner(2) - corner(0)).squaredNorm();
  if (std::abs(sum) <= kFlat * size) return false;
  weights = twice_areas / sum;
  return weights.minCoeff() >= kOutside;
}

double height(const Patch& patch, int face, const Vec3& weights) {
  double w = 0.0;
  for (int k = 0; k < 3; ++k) w += weights[k] * patch.uvw(2, (*patch.faces)(k, face));
  return w;
}

}  // namespace

std::optional<Facing> facing_at(const PixelPair& pair, const ContactCamera& camera, const Patch& a,
                                int face_a, const Patch& b, int face_b) {
  Facing at;
  at.u = camera.u(static_cast<int>(pair.pixel) % camera.width);
  at.v = camera.v(static_cast<int>(pair.pixel) / camera.width);
  if (!barycentric(a, face_a, at.u, at.v, at.weights_a) ||
      !barycentric(b, face_b, at.u, at.v, at.weights_b)) {
    counters::count("contact.edge_on");
    return std::nullopt;
  }
  at.w_a = height(a, face_a, at.weights_a);
  at.w_b = height(b, face_b, at.weights_b);
  return at;
}

ContactSample sample_of(const Facing& at, const ImageSide& a, int face_a, const ImageSide& b, int face_b,
                        const ContactCamera& camera, const ContactAxes& axes) {
  ContactSample sample;
  sample.a = a.point(face_a, at.weights_a, axes.world(Vec3(at.u, at.v, at.w_a)));
  sample.b = b.point(face_b, at.weights_b, axes.world(Vec3(at.u, at.v, at.w_b)));
  sample.normal = axes.normal();
  sample.area = camera.pixel * camera.pixel;
  sample.gap = at.gap();
  return sample;
}

}  // namespace palpate::contact
