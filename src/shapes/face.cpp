#include "face.h"

#include <numbers>

#include "noise.h"
#include "solids.h"

// Proportions in millimetres, scaled to a head of 240: pupils 64 apart, nose 34 wide and 22 high, mouth 52
// wide, ear 63 high, as in anthropometric tables (Farkas, "Anthropometry of the Head and Face", 1994: means
// for adults, rounded).
namespace palpate::shapes {
namespace {

const Vec3 kEye(32, -77, 0);

/// Heights of the lids' edges relative to the centre of the eye, at u from the middle of the eye.
double upper_lid(double u) { return 5.6 * (1.0 - u * u / 210.0) + 0.05 * u; }
double lower_lid(double u) { return -4.2 * (1.0 - u * u / 210.0) + 0.05 * u; }

}  // namespace

double with_eye(double head, const Vec3& p, bool fine) {
  const double away = (p - kEye).norm();
  if (away > 70.0) return head;
  const double socket = ellipsoid(p, {32, -99, -1}, {21, 15, 12});
  head = carve(head, socket, fine ? 14.0 : 20.0);
  if (!fine) return join(head, away - 13.5, 10.0);
  const double u = p.x() - kEye.x(), w = p.z() - kEye.z();
  double eyeball = away - 13.0;
  const double iris = std::hypot(u, w - 0.4);
  if (p.y() < kEye.y()) {
    eyeball += 0.55 * (1.0 - ramp(iris, 4.7, 5.5)) + 1.3 * (1.0 - ramp(iris, 1.4, 2.4));
    // glint, as sculptors carve it
    eyeball -= 0.5 * (1.0 - ramp(std::hypot(u - 1.6, w - 2.0), 0.6, 1.4));
  }
  // Lids: a ball around the eyeball, open down to it between the two edges; a fold above the upper lid.
  const double opening =
      std::max({0.9 * (w - upper_lid(u)), 0.9 * (lower_lid(u) - w), -eyeball, p.y() + 78.0}) +
      2.0 * ramp(std::abs(u), 9.5, 14.0);
  head = join(head, carve(ball(p, kEye, 14.9), opening, 1.0), 9.0);
  const double fold = std::hypot(w - 5.2 - upper_lid(u), away - 15.8) - 1.0 +
                      4.0 * (ramp(std::abs(u), 10.0, 15.0) + ramp(p.y(), -86.0, -80.0));
  head = carve(head, fold, 3.0);
  return join(head, eyeball, 0.6);
}

double with_nose(double head, const Vec3& p, bool fine) {
  if ((p - Vec3(0, -95, -20)).norm() > 90.0) return head;
  head = join(head, limb(p, {0, -82, 2}, {0, -93, -34}, 8.0, 11.5), 9.0);  // body of the nose, between the
                                                                           // cheeks
  const double bridge = limb(p, {0, -88, 8}, {0, -109, -32}, 6.0, 8.5);
  head = join(head, bridge, fine ? 11.0 : 16.0);
  head = join(head, ball(p, {0, -110, -34}, 9.2), 6.0);
  head = join(head, ellipsoid(p, {11.0, -97.0, -38.5}, {6.6, 10.5, 6.6}), fine ? 5.5 : 8.0);
  if (!fine) return head;
  // columella
  head = join(head, limb(p, {0, -104, -43}, {0, -98, -46}, 3.2, 3.5), 4.0);
  // nostril
  head = carve(head, ellipsoid(p, {6.6, -102.5, -45.5}, {3.6, 6.0, 4.2}, rotation_xyz(20, 0, -18)), 2.0);
  const double crease = limb(p, {18.5, -94, -34}, {17.5, -90, -43}, 1.2, 1.2);
  return carve(head, crease, 2.5);
}

double with_mouth(double head, const Vec3& p, bool fine) {
  if ((p - Vec3(0, -95, -66)).norm() > 90.0) return head;
  if (!fine) return join(head, ellipsoid(p, {0, -92, -68}, {22, 8, 10}), 14.0);
  head = carve(head, limb(p, {0, -98.5, -50}, {0, -100.5, -59}, 1.6, 2.2), 4.0);  // philtrum
  // Upper lip: from the middle over the bow to the corner; then the fuller lower lip.
  double upper = limb(p, {0, -97.0, -65.0}, {7, -96.6, -63.4}, 3.9, 4.0);
  upper = join(upper, limb(p, {7, -96.6, -63.4}, {25, -86.5, -68.5}, 4.0, 1.4), 2.0);
  double lower = limb(p, {0, -95.8, -73.6}, {9, -95.2, -73.2}, 5.3, 5.0);
  lower = join(lower, limb(p, {9, -95.2, -73.2}, {24, -87.0, -69.6}, 5.0, 1.4), 2.0);
  head = join(head, upper, 2.6);
  head = join(head, lower, 3.0);
  double line = limb(p, {0, -101.5, -68.9}, {10, -100.0, -68.6}, 1.1, 1.1);
  line = std::min(line, limb(p, {10, -100.0, -68.6}, {27, -87.5, -69.4}, 1.1, 0.9));
  head = carve(head, line, 2.2);
  // below the lower lip
  head = carve(head, limb(p, {0, -96.5, -84.5}, {12, -92, -83.5}, 3.0, 2.0), 7.0);
  // nasolabial fold
  const double fold = limb(p, {21, -92, -42}, {33, -80, -66}, 1.2, 1.2);
  return carve(head, fold, 6.0);
}

double with_ear(double head, const Vec3& p, bool fine) {
  static const Vec3 middle(71, 19, -11);
  // Axes of the ear: backwards (and 28 degrees away from the head), up (leaning back), outwards.
  static const Vec3 back = Vec3(0.47, 0.88, 0).normalized();
  static const Vec3 up = (Vec3(0.05, 0.22, 1) - Vec3(0.05, 0.22, 1).dot(back) * back).normalized();
  static const Vec3 outwards = back.cross(up);
  const Vec3 d = p - middle;
  if (d.norm() > 62.0) return head;
  const Vec3 q(d.dot(back), d.dot(up), d.dot(outwards));
  const double s = q.x() / (1.0 + 0.006 * q.y()), t = q.y();  // egg, wider above
  const Vec3 egg(s, t, q.z());
  if (!fine) return join(head, ellipsoid(egg, {0, -1, 0}, {17, 32, 7.5}), 12.0);
  double ear = ellipsoid(egg, {0, 0, -0.5}, {16, 30, 3.6});
  const double root = ellipsoid(q, {-9, -2, -6}, {9, 22, 8});
  ear = join(ear, root, 4.0);
  const double rho = std::hypot(s / 14.6, t / 28.0),
               theta = std::atan2(t / 28.0, s / 14.6) * 180.0 / std::numbers::pi;
  // The rim (helix) runs from the lobe up the back and over the top into the hollow; the ridge inside it
  // (antihelix) stays at the back.
  const double turn = theta < -100.0 ? theta + 360.0 : theta;
  const double rim_here = ramp(turn, -75.0, -35.0) * (1.0 - ramp(turn, 175.0, 205.0));
  const double rim = std::hypot((rho - 1.0) * 15.0, q.z() - 3.2) - (5.0 * rim_here - 1.5);
  ear = join(ear, rim, 2.5);
  const double hollow = ellipsoid(egg, {-3.5, -7, 5.5}, {8.0, 12.5, 8.0});
  ear = carve(ear, hollow, 3.5);
  const double ridge_here = ramp(turn, -80.0, -45.0) * (1.0 - ramp(turn, 60.0, 95.0));
  const double ridge = std::hypot((rho - 0.60) * 16.0, q.z() - 2.6) - (4.1 * ridge_here - 1.5);
  ear = join(ear, ridge, 2.5);
  ear = join(ear, ellipsoid(q, {-3, -27, 0.5}, {9.0, 11.0, 4.4}), 6.0);                           // lobe
  ear = join(ear, ellipsoid(q, {-12.5, -9, 3.0}, {3.6, 6.0, 4.5}, rotation_xyz(0, 0, 10)), 4.5);  // tragus
  return join(head, ear, 3.0);
}

double with_hair(double head, const Vec3& p, double wavelength) {
  const double forward =
      -(0.70 * p.y() + 0.714 * p.z()) - 3.0 - 5.0 * ramp(p.x(), 0.0, 40.0) + 6.0 * ramp(p.x(), 40.0, 70.0);
  double cap = ellipsoid(p, {0, 14, 37}, {81.0, 100.5, 84.0});
  cap = join(cap, ellipsoid(p, {0, 50, 0}, {63, 60, 58}), 10.0);
  if (std::abs(cap) < 8.0 && wavelength > 0.0) {
    const double radius = std::hypot(p.x(), p.z() - 20.0);
    const double turn = std::atan2(p.x(), p.z() - 20.0);
    const double sway = 1.6 * noise({p.y() / 38.0, 3.0 * turn, 0.5}, 3);
    double strands = 0.0;
    for (int octave = 0; octave < 3; ++octave) {
      const double number = 34.0 * std::pow(1.9, octave);
      const double fade = ramp(radius * 2.0 * std::numbers::pi / number, wavelength, 2.0 * wavelength);
      strands += fade * 1.1 * std::pow(0.62, octave) *
                 std::cos(number * turn + sway * (1.0 + octave) + 2.1 * octave * std::sin(turn));
    }
    cap -= strands;
  }
  return join(head, meet(cap, forward, 5.0), 2.5);
}

double eyebrow(const Vec3& p, double wavelength) {
  if (p.y() > -50.0 || p.z() < 5.0 || p.z() > 40.0) return 0.0;
  // Curve over the eye in the frontal view, thick inside and thin outside.
  const double along = std::clamp((p.x() - 9.0) / 43.0, 0.0, 1.0);
  const double height = 17.0 + 7.5 * along * (1.9 - 1.55 * along);
  const double half_width = 3.6 - 2.0 * along;
  const double outside = std::max(std::abs(p.z() - height) - half_width, std::abs(p.x() - 30.5) - 21.5);
  const double here = 1.0 - ramp(outside, -1.6, 1.2);
  double hairs = 0.0;
  if (wavelength > 0.0 && wavelength < 5.0)
    hairs = 0.35 * std::cos(2.0 * std::numbers::pi * (p.x() + 0.7 * (p.z() - height)) / 4.6);
  return here * (1.9 + hairs);
}

double skin_relief(const Vec3& p, double wavelength) {
  double out = 0.0;
  const double forehead = ramp(-p.y(), 62.0, 80.0) * ramp(p.z(), 30.0, 40.0) *
                          (1.0 - ramp(p.z(), 62.0, 72.0)) * (1.0 - ramp(p.x(), 34.0, 52.0));
  if (forehead > 0.0 && wavelength < 6.0)
    out += 0.32 * forehead *
           std::cos(2.0 * std::numbers::pi *
                    (p.z() + 2.0 * std::cos(p.x() / 11.0) + noise({p.x() / 14, 0.3, p.z() / 20}, 5)) / 8.5);
  for (int octave = 0; octave < 4; ++octave) {
    const double size = 9.0 * std::pow(0.5, octave);
    if (size < wavelength) break;
    out += 0.16 * std::pow(0.6, octave) * noise(p / size, 11U + static_cast<unsigned>(octave));
  }
  return out;
}

}  // namespace palpate::shapes
