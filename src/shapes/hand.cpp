#include "hand.h"

#include <numbers>

#include "figure.h"
#include "solids.h"

// The hand hangs from the wrist with its palm towards the thigh.  Axes of the hand: `along` to the
// fingertips, `across` from the little finger to the index finger (forwards), `through` from the palm to the
// back of the hand (outwards).
namespace palpate::shapes {
namespace {

struct HandAxes {
  Vec3 along, across, through;
  HandAxes() {
    along = (figure::kKnuckles - figure::kWrist).normalized();
    const Vec3 forwards = Vec3(0.25, -1, 0);
    across = (forwards - forwards.dot(along) * along).normalized();
    through = along.cross(across);
    if (through.x() < 0) through = -through;
  }
};

/// One finger: position of its knuckle (along, across) [m], direction in the hand's plane [degrees towards
/// the index finger], lengths [m], radii [m].
struct Finger {
  double along, across, spread_deg, first, rest, thick, thin;
};
constexpr Finger kFingers[4] = {{0.088, 0.031, 8.0, 0.044, 0.044, 0.0090, 0.0066},
                                {0.092, 0.0105, 2.0, 0.049, 0.050, 0.0092, 0.0066},
                                {0.089, -0.0105, -4.5, 0.046, 0.047, 0.0088, 0.0064},
                                {0.082, -0.030, -12.0, 0.036, 0.038, 0.0078, 0.0058}};

}  // namespace

double hand(const Vec3& p, bool fine) {
  static const HandAxes axes;
  const Vec3 d = p - figure::kWrist;
  const Vec3 q(d.dot(axes.along), d.dot(axes.across), d.dot(axes.through));
  double palm = limb(q, {0.0, 0, 0}, {0.02, 0.002, 0}, 0.0225, 0.0205);
  palm = join(palm, ellipsoid(q, {0.052, 0.001, -0.001}, {0.052, 0.040, 0.0165}), 0.016);
  palm = join(palm, limb(q, {0.072, 0.029, 0}, {0.072, -0.026, 0}, 0.0120, 0.0105), 0.014);
  const Vec3 thumb_root(0.026, 0.022, -0.008), thumb_knuckle(0.062, 0.049, -0.015),
      thumb_tip(0.098, 0.062, -0.014);
  if (!fine) {
    const double mitten = ellipsoid(q, {0.128, 0.002, -0.006}, {0.066, 0.051, 0.0155});
    const double thumb = join(limb(q, thumb_root, thumb_knuckle, 0.017, 0.0125),
                              limb(q, thumb_knuckle, thumb_tip, 0.0125, 0.0100), 0.006);
    return join(join(palm, mitten, 0.020), thumb, 0.014);
  }
  double out = palm;
  for (const Finger& f : kFingers) {
    const double angle = f.spread_deg * std::numbers::pi / 180.0, c = std::cos(angle), s = std::sin(angle);
    const Vec3 knuckle(f.along, f.across, 0.001);
    const Vec3 middle = knuckle + f.first * Vec3(c, s, -0.12);  // slightly bent towards the palm
    const Vec3 tip = middle + f.rest * Vec3(c, s, -0.30);
    const double mean = 0.5 * (f.thick + f.thin);
    double finger = join(limb(q, knuckle, middle, f.thick, mean + 0.0004, -0.0006),
                         limb(q, middle, tip, mean + 0.0004, f.thin, 0.0002, 0.6), 0.0015);
    finger = join(finger, ball(q, knuckle + Vec3(-0.002, 0, 0.003), f.thick), 0.004);
    out = join(out, finger, 0.0045);
  }
  const double thumb = join(limb(q, thumb_root, thumb_knuckle, 0.0155, 0.0105),
                            limb(q, thumb_knuckle, thumb_tip, 0.0105, 0.0078), 0.004);
  return join(out, thumb, 0.010);
}

double foot(const Vec3& p, bool fine) {
  using figure::kAnkle, figure::kHeel, figure::kToes;
  double d = limb(p, kHeel, {0.130, 0.010, 0.040}, 0.031, 0.034);
  d = join(d, limb(p, kAnkle, {0.136, -0.045, 0.052}, 0.038, 0.030), 0.022);
  d = join(d, limb(p, {0.136, -0.045, 0.052}, {0.146, -0.112, 0.024}, 0.029, 0.021), 0.020);
  d = join(d, limb(p, {0.152, -0.020, 0.024}, {0.170, -0.105, 0.019}, 0.022, 0.018), 0.020);  // outer edge
  // ball of the foot
  d = join(d, limb(p, {0.130, -0.112, 0.022}, {0.172, -0.098, 0.017}, 0.020, 0.015), 0.018);
  if (fine) {
    const Vec3 root[5] = {{0.128, -0.126, 0.019},
                          {0.1425, -0.131, 0.017},
                          {0.155, -0.127, 0.0155},
                          {0.1665, -0.119, 0.014},
                          {0.177, -0.108, 0.013}};
    const double length[5] = {0.040, 0.036, 0.032, 0.027, 0.022},
                 radius[5] = {0.0118, 0.0080, 0.0076, 0.0072, 0.0070};
    for (int toe = 0; toe < 5; ++toe) {
      const double turn = (toe - 0.6) * 0.05;
      const Vec3 tip = root[toe] + length[toe] * Vec3(0.10 + turn, -1, -0.10);
      d = join(d, limb(p, root[toe], tip, radius[toe], radius[toe], 0.0010, 0.7), 0.005);
    }
    d = join(d, ellipsoid(p, {0.164, 0.022, 0.088}, {0.010, 0.013, 0.013}), 0.014);  // ankle bones
    d = join(d, ellipsoid(p, {0.094, 0.014, 0.095}, {0.009, 0.013, 0.013}), 0.014);
  } else {
    d = join(d, limb(p, {0.134, -0.148, 0.018}, {0.170, -0.124, 0.016}, 0.017, 0.014), 0.016);
  }
  return meet(d, 0.001 - p.z(), 0.010);  // the ground
}

}  // namespace palpate::shapes
