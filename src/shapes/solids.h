#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "palpate/core/types.h"

/// Solids as implicit functions (negative inside, approximately the signed distance near the surface), and
/// their smooth set operations.  Any unit of length, the same for all arguments.
namespace palpate::shapes {

/// Smooth union: min(a, b), rounded where they differ by less than k:
///   min(a, b) - k h^2 / 4,   h = max(k - |a - b|, 0) / k.
/// At a = b it is k/4 below the minimum; at |a - b| = k its value and slope equal those of min(a, b). Bitwise
/// symmetric in a and b.
inline double join(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - 0.25 * k * h * h;
}
/// Smooth intersection.
inline double meet(double a, double b, double k) { return -join(-a, -b, k); }
/// Smooth difference: `a` without `b`.
inline double carve(double a, double b, double k) { return meet(a, -b, k); }

/// Smoothstep from 0 at t <= low to 1 at t >= high with zero slope at both ends: 3 s^2 - 2 s^3.
inline double ramp(double t, double low, double high) {
  const double s = std::clamp((t - low) / (high - low), 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

/// Signed distance to a ball.
inline double ball(const Vec3& p, const Vec3& centre, double radius) { return (p - centre).norm() - radius; }

/// Ellipsoid along the axes: g = |q| - 1 with q = (p - c)/r componentwise, divided by |grad g| = |q/r| / |q|:
/// the distance to first order (Taubin 1994).
inline double ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii) {
  const Vec3 q = (p - centre).cwiseQuotient(radii);
  const double length = q.norm();
  if (length < 1e-6) return -radii.minCoeff();
  return (length - 1.0) * length / q.cwiseQuotient(radii).norm();
}
/// Ellipsoid whose axes are the columns of `axes`.
inline double ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii, const Mat3& axes) {
  return ellipsoid(Vec3(axes.transpose() * (p - centre)), Vec3::Zero(), radii);
}

/// Limb from a to b: balls along a segment, whose radius varies linearly from ra to rb and swells by `belly`
/// around the parameter `at` in (0, 1).  The swelling is 16 t'^2 (1 - t')^2 in t' = t^e,
/// e = ln(1/2) / ln(at): 1 at t = at, with zero slope at both ends.
inline double limb(const Vec3& p, const Vec3& a, const Vec3& b, double ra, double rb, double belly = 0.0,
                   double at = 0.5) {
  const Vec3 along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  double radius = ra + (rb - ra) * t;
  if (belly != 0.0 && t > 0.0 && t < 1.0) {
    const double u = at == 0.5 ? t : std::pow(t, std::log(0.5) / std::log(at));
    radius += belly * 16.0 * u * u * (1.0 - u) * (1.0 - u);
  }
  return (p - a - t * along).norm() - radius;
}

/// Returns the rotation matrix of right-handed rotations about x, then y, then z [degrees].
inline Mat3 rotation_xyz(double about_x_deg, double about_y_deg, double about_z_deg) {
  const double degree = std::numbers::pi / 180.0;
  return (Eigen::AngleAxisd(about_z_deg * degree, Vec3::UnitZ()) *
          Eigen::AngleAxisd(about_y_deg * degree, Vec3::UnitY()) *
          Eigen::AngleAxisd(about_x_deg * degree, Vec3::UnitX()))
      .toRotationMatrix();
}

/// Returns the mirror image about x = 0.
inline Vec3 mirrored(const Vec3& p) { return {-p.x(), p.y(), p.z()}; }

}  // namespace palpate::shapes
