#include "human.h"

#include <algorithm>
#include <cmath>

#include "contour.h"
#include "figure.h"
#include "hand.h"
#include "head.h"
#include "solids.h"

// Torso and limbs are limbs and ellipsoids on the joints of figure.h; muscles are ellipsoids joined to them;
// head and hands have separate formulas.  Parts near the middle are joined with their mirror images, so that
// the body is smooth there.
namespace palpate::shapes {
namespace {

using namespace figure;

constexpr double kHeadScale = 1e-3 * kHead / 0.240;  // metres per millimetre of head_mm
const Vec3 kHeadOrigin(0, -0.006, kHeight - 120.0 * kHeadScale);

/// Returns the union of a part and its mirror image.
template <class Part>
double both(const Vec3& p, double k, Part&& part) {
  return join(part(p), part(mirrored(p)), k);
}

/// Evaluates a part only near its bounding ball; elsewhere returns a lower bound of the distance.
template <class Part>
double when_near(const Vec3& p, const Vec3& centre, double radius, Part&& part) {
  const double away = (p - centre).norm() - radius;
  return away > 0.08 ? away : part();
}

double torso(const Vec3& p, bool fine) {
  // pelvis
  double d = ellipsoid(p, {0, 0.010, 0.945}, {0.152, 0.100, 0.115});
  // waist
  d = join(d, ellipsoid(p, {0, 0.006, 1.085}, {0.131, 0.090, 0.150}), 0.06);
  // ribs
  d = join(d, ellipsoid(p, {0, 0.012, 1.262}, {0.148, 0.106, 0.175}), 0.06);
  // back
  d = join(d,
           both(p, 0.02,
                [](const Vec3& q) {
                  return ellipsoid(q, {0.105, 0.040, 1.285}, {0.062, 0.060, 0.125});
                }),
           0.04);
  // shoulder girdle
  d = join(d,
           both(p, 0.03,
                [](const Vec3& q) {
                  return limb(q, {0.040, 0.010, 1.405}, {0.165, 0.014, 1.400}, 0.062, 0.050);
                }),
           0.05);
  // trapezius
  d = join(d,
           both(p, 0.02,
                [](const Vec3& q) {
                  return limb(q, {0.018, 0.034, 1.510}, {0.140, 0.026, 1.432}, 0.034, 0.030);
                }),
           0.05);
  // buttocks
  d = join(d,
           both(p, 0.015,
                [](const Vec3& q) {
                  return ellipsoid(q, {0.073, 0.066, 0.918}, {0.076, 0.066, 0.086}, rotation_xyz(-12, 0, 0));
                }),
           0.025);
  const double chest = both(p, 0.010, [](const Vec3& q) {
    return ellipsoid(q, {0.074, -0.066, 1.318}, {0.080, 0.032, 0.056}, rotation_xyz(8, 14, 14));
  });
  d = join(d, chest, fine ? 0.034 : 0.05);
  if (!fine) return d;
  // along the spine
  d = carve(d, limb(p, {0, 0.124, 1.06}, {0, 0.128, 1.40}, 0.008, 0.006), 0.03);
  // down the belly
  d = carve(d, limb(p, {0, -0.100, 1.03}, {0, -0.112, 1.24}, 0.004, 0.003), 0.018);
  // navel
  d = carve(d, ball(p, {0, -0.094, 1.050}, 0.006), 0.008);
  // collar bones
  d = join(d,
           both(p, 0.01,
                [](const Vec3& q) {
                  return limb(q, {0.012, -0.040, 1.440}, {0.150, -0.016, 1.452}, 0.011, 0.010);
                }),
           0.018);
  return join(d, both(p, 0.01, [](const Vec3& q) { return ball(q, {0.088, -0.099, 1.290}, 0.0045); }), 0.004);
}

double leg(const Vec3& p, bool fine) {
  const Vec3 above_knee = kHip + 0.92 * (kKnee - kHip);
  double d = limb(p, kHip, kKnee, 0.088, 0.055, 0.004, 0.35);
  // front of the thigh
  d = join(d, ellipsoid(p, {0.107, -0.026, 0.720}, {0.058, 0.056, 0.155}), 0.04);
  d = join(d, ellipsoid(p, {0.098, 0.036, 0.700}, {0.052, 0.048, 0.150}), 0.04);  // back of the thigh
  d = join(d, ellipsoid(p, above_knee + Vec3(0.0, -0.024, -0.030), {0.036, 0.034, 0.044}), 0.03);  // knee cap
  d = join(d, limb(p, kKnee, kAnkle, 0.052, 0.034), 0.03);
  d = join(d, ellipsoid(p, {0.112, 0.034, 0.372}, {0.044, 0.038, 0.110}), 0.04);  // calf
  d = join(d, ellipsoid(p, {0.138, 0.030, 0.385}, {0.030, 0.034, 0.100}), 0.03);
  d = join(d, limb(p, {0.127, 0.048, 0.24}, {0.127, 0.058, 0.05}, 0.018, 0.016), 0.03);  // Achilles' tendon
  if (fine) {
    // Inner and outer muscle heads above the knee.
    d = join(d, ellipsoid(p, {0.084, -0.034, 0.570}, {0.024, 0.026, 0.050}), 0.02);
    d = join(d, ellipsoid(p, {0.140, -0.030, 0.590}, {0.022, 0.024, 0.060}), 0.02);
    d = join(d, limb(p, {0.112, -0.046, 0.43}, {0.124, -0.012, 0.13}, 0.012, 0.010), 0.025);  // shin
  }
  return join(d, when_near(p, {0.14, -0.05, 0.06}, 0.20, [&] { return foot(p, fine); }), 0.02);
}

double arm(const Vec3& p, bool fine) {
  double d = limb(p, kShoulder, kElbow, 0.049, 0.037);
  // deltoid
  d = join(d,
           ellipsoid(p, kShoulder + Vec3(0.018, 0.0, -0.026), {0.047, 0.056, 0.078}, rotation_xyz(0, -22, 0)),
           0.03);
  const Mat3 lean = rotation_xyz(0, -28, 0);
  // biceps
  d = join(d,
           ellipsoid(p, kShoulder + 0.56 * (kElbow - kShoulder) + Vec3(0.0, -0.020, 0.0),
                     {0.033, 0.032, 0.080}, lean),
           0.02);
  // triceps
  d = join(d,
           ellipsoid(p, kShoulder + 0.50 * (kElbow - kShoulder) + Vec3(0.004, 0.022, 0.0),
                     {0.034, 0.032, 0.090}, lean),
           0.02);
  d = join(d, limb(p, kElbow, kWrist, 0.036, 0.0245, 0.006, 0.25), 0.02);
  d = join(d,
           ellipsoid(p, kElbow + 0.26 * (kWrist - kElbow) + Vec3(0.010, -0.008, 0.0), {0.034, 0.036, 0.075},
                     rotation_xyz(10, -25, 0)),
           0.025);
  if (fine) d = join(d, ball(p, kElbow + Vec3(0.004, 0.030, 0.004), 0.012), 0.02);
  return join(d, when_near(p, kKnuckles, 0.14, [&] { return hand(p, fine); }), 0.015);
}

double head_and_neck(const Vec3& p, bool fine) {
  double d = limb(p, {0, 0.026, 1.40}, {0, 0.012, 1.585}, 0.056, 0.050);
  if (fine) {
    // sternocleidomastoid
    d = join(d, limb(p, {0.050, 0.022, 1.588}, {0.014, -0.030, 1.440}, 0.009, 0.010), 0.016);
    d = join(d, ellipsoid(p, {0, -0.034, 1.492}, {0.008, 0.009, 0.015}), 0.012);
  }
  return join(d, kHeadScale * head_mm((p - kHeadOrigin) / kHeadScale, {fine, false, 0.0}), 0.014);
}

double size_of(const Vec3& place) {
  const Vec3 p(std::abs(place.x()), place.y(), place.z());
  const auto near = [&](const Vec3& centre, double inner, double outer) {
    return 1.0 - ramp((p - centre).norm(), inner, outer);
  };
  double size = 1.0 - 0.50 * near(kHeadOrigin, 0.12, 0.20);
  size = std::min(size, 1.0 - 0.64 * near(kHeadOrigin + Vec3(0, -0.09, -0.03), 0.060, 0.13));
  size = std::min(size, 1.0 - 0.66 * near(kKnuckles + Vec3(0.02, -0.01, -0.03), 0.095, 0.17));
  return std::min(size, 1.0 - 0.60 * near(kToes, 0.05, 0.12));
}

}  // namespace

double human(const Vec3& place, bool fine) {
  const Vec3 p(std::abs(place.x()), place.y(), place.z());
  const double body = when_near(p, {0, 0, 1.20}, 0.42, [&] { return torso(p, fine); });
  const double legs =
      when_near(p, {0.11, 0, 0.45}, 0.56, [&] { return join(leg(p, fine), leg(mirrored(p), fine), 0.03); });
  const double arms = when_near(p, {0.32, 0, 1.07}, 0.46, [&] { return arm(p, fine); });
  const double top = when_near(p, {0, 0, 1.60}, 0.24, [&] { return head_and_neck(p, fine); });
  return join(join(join(body, legs, 0.035), top, 0.030), arms, 0.030);
}

Shape make_human(const Resolution& resolution) {
  Shape shape;
  shape.name = "human";
  shape.tetrahedra = 10340;
  shape.nodes = 3563;
  shape.inside = [](const Vec3& p) { return human(p, false); };
  shape.skeleton = skeleton();
  Blueprint plan;
  plan.inside = shape.inside;
  plan.low = Vec3(-0.62, -0.25, -0.06);
  plan.high = Vec3(0.62, 0.25, 1.82);
  plan.lattice = 0.008;
  plan.symmetric = true;
  shape.base = contour(plan, resolution.base_vertices);
  plan.inside = [](const Vec3& p) { return human(p, true); };
  plan.size = size_of;
  // A finer mesh resolves narrower gaps.
  plan.lattice = 0.0046 * std::min(1.0, std::sqrt(60000.0 / resolution.skin_vertices));
  plan.lipschitz = 2.0;
  shape.skin = contour(plan, resolution.skin_vertices);
  return shape;
}

}  // namespace palpate::shapes
