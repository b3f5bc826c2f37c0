#include "gear_profile.h"

#include <cmath>
#include <numbers>

#include "palpate/core/error.h"

// Half a tooth, from the middle of the tip with growing polar angle:
//   tip arc   radius ra, from angle 0 to the flank's end
//   involute  of the base circle rb: at roll t the radius is rb sqrt(1 + t^2) and the polar angle has
//             advanced by t - atan t = inv(alpha), alpha = atan t.  On the pitch circle half a tooth spans
//             pi / (2 z), so the polar angle of the flank is
//               h(t) = pi / (2 z) + inv(alpha_0) - (t - atan t)
//   line      radial, from the base circle in to the fillet
//   fillet    a circle of radius f that touches the radial line and, from outside, the root circle
//   root arc  to the middle of the gap at pi / z
// Areas swept by the radius, 1/2 int r^2 dtheta = 1/2 int (x dy - y dx):
//   arc          1/2 r^2 dtheta
//   radial line  0
//   involute     rb^2 t^3 / 6,   from d(t - atan t) = t^2/(1 + t^2) dt
//   fillet       1/2 [f c x (u1 - u0) + f^2 (phi1 - phi0)],   its points c + f u(phi) about its centre c
namespace palpate::shapes {
namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }
Point2 polar(double r, double angle) { return {r * std::cos(angle), r * std::sin(angle)}; }
double cross(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Parameters common to the pieces of half a tooth.
struct HalfTooth {
  double ra, rb, rf, f;
  double roll_tip;      // roll of the involute at the tip circle
  double flank_base;    // polar angle of the flank on the base circle and of the radial line
  double middle;        // polar angle of the middle of the gap
  Point2 centre;        // centre of the fillet
  double touch_radius;  // radius at which the fillet leaves the radial line
  double root_angle;    // polar angle at which the fillet meets the root circle

  explicit HalfTooth(const GearSize& g)
      : ra(g.tip_radius()), rb(g.base_radius()), rf(g.root_radius()), f(g.fillet * g.module) {
    const double t0 = std::tan(radians(g.pressure_angle_deg));
    roll_tip = std::sqrt(ra * ra / (rb * rb) - 1.0);
    flank_base = std::numbers::pi / (2.0 * g.teeth) + t0 - std::atan(t0);
    middle = std::numbers::pi / g.teeth;
    // The centre is at distance f from the radial line (towards the gap) and from the root circle (outside).
    const double along = std::sqrt((rf + f) * (rf + f) - f * f);
    touch_radius = along;
    centre = along * polar(1.0, flank_base) + f * polar(1.0, flank_base + 0.5 * std::numbers::pi);
    root_angle = std::atan2(centre.y(), centre.x());
    PALPATE_CHECK(touch_radius < rb && root_angle < middle && angle(roll_tip) > 0.0,
                  "a gear cannot have {} teeth", g.teeth);
  }
  double angle(double roll) const { return flank_base - (roll - std::atan(roll)); }
};

}  // namespace

double GearSize::base_radius() const { return pitch_radius() * std::cos(radians(pressure_angle_deg)); }

double gear_area(const GearSize& size) {
  const HalfTooth h(size);
  const double tip = 0.5 * h.ra * h.ra * h.angle(h.roll_tip);
  const double flank = h.rb * h.rb * std::pow(h.roll_tip, 3) / 6.0;
  // u at both ends: from the centre to the radial line, and from the centre to the axis.
  const Point2 u0 = -polar(1.0, h.flank_base + 0.5 * std::numbers::pi), u1 = -polar(1.0, h.root_angle);
  const double turn = std::atan2(cross(u0, u1), u0.dot(u1));
  const double fillet = 0.5 * (h.f * cross(h.centre, u1 - u0) + h.f * h.f * turn);
  const double root = 0.5 * h.rf * h.rf * (h.middle - h.root_angle);
  return 2.0 * size.teeth * (tip + flank + fillet + root);
}

GearProfile gear_profile(const GearSize& size, double spacing) {
  const HalfTooth h(size);
  std::vector<Point2> points, normals;  // half a tooth
  const auto pieces = [&](double length, int least) {
    return std::max(least, static_cast<int>(std::lround(length / spacing)));
  };
  const auto add = [&](const Point2& p, const Point2& n) {
    points.push_back(p), normals.push_back(n.normalized());
  };
  const auto on_flank = [&](double t) { return polar(h.rb * std::sqrt(1.0 + t * t), h.angle(t)); };
  // The involute's normal is tangent to the base circle: it points along the unwound string, at angle h(t) +
  // pi/2 - atan t.
  const auto flank_normal = [&](double t) {
    return polar(1.0, h.angle(t) + 0.5 * std::numbers::pi - std::atan(t));
  };

  const double tip_angle = h.angle(h.roll_tip);
  int n = pieces(h.ra * tip_angle, 1);
  for (int i = 0; i < n; ++i) add(polar(h.ra, tip_angle * i / n), polar(1.0, tip_angle * i / n));
  const int corner = n;
  const Point2 a = polar(1.0, tip_angle), b = flank_normal(h.roll_tip);
  points.push_back(polar(h.ra, tip_angle));
  normals.push_back((a + b) / (1.0 + a.dot(b)));
  n = pieces(0.5 * h.rb * h.roll_tip * h.roll_tip, 3);  // arc length of an involute: rb t^2 / 2
  for (int i = 1; i <= n; ++i) {
    const double t = h.roll_tip * std::sqrt(1.0 - static_cast<double>(i) / n);
    add(on_flank(t), flank_normal(t));
  }
  n = pieces(h.rb - h.touch_radius, 1);
  const Point2 radial = polar(1.0, h.flank_base), beside = polar(1.0, h.flank_base + 0.5 * std::numbers::pi);
  for (int i = 1; i <= n; ++i) add((h.rb + (h.touch_radius - h.rb) * i / n) * radial, beside);
  const Point2 u0 = -beside, u1 = -polar(1.0, h.root_angle);
  const double turn = std::atan2(cross(u0, u1), u0.dot(u1)), start = std::atan2(u0.y(), u0.x());
  n = pieces(h.f * std::abs(turn), 3);
  for (int i = 1; i <= n; ++i) {
    const Point2 u = polar(1.0, start + turn * i / n);
    add(h.centre + h.f * u, -u);
  }
  n = pieces(h.rf * (h.middle - h.root_angle), 1);
  for (int i = 1; i <= n; ++i) {
    const double angle = h.root_angle + (h.middle - h.root_angle) * i / n;
    add(polar(h.rf, angle), polar(1.0, angle));
  }

  // The other half is the mirror image about the middle of the gap; then all teeth.
  const int half = static_cast<int>(points.size()) - 1;  // the last point is the gap's middle
  GearProfile out;
  for (int tooth = 0; tooth < size.teeth; ++tooth) {
    const Eigen::Rotation2Dd this_tooth(2.0 * h.middle * tooth), other(2.0 * h.middle * (tooth + 1));
    for (int i = 0; i <= half; ++i) {
      if (i == corner) out.corners.push_back(static_cast<int>(out.points.size()));
      out.points.push_back(this_tooth * points[i]);
      out.normals.push_back(this_tooth * normals[i]);
    }
    for (int i = half - 1; i >= 1; --i) {
      if (i == corner) out.corners.push_back(static_cast<int>(out.points.size()));
      out.points.push_back(other * Point2(points[i].x(), -points[i].y()));
      out.normals.push_back(other * Point2(normals[i].x(), -normals[i].y()));
    }
  }
  return out;
}

}  // namespace palpate::shapes
