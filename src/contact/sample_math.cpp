#include "contact/sample_math.h"

#include <algorithm>

namespace palpate::contact {
namespace {

constexpr double kLongest = 1e-9;  // A spring that was cut to its maximum has that length up to rounding.

}  // namespace

Vec3 sliding_velocity(const ContactSample& sample, const SampleMotion& motion) {
  return motion.a.v - motion.b.v - motion.rate * sample.normal + sample.deflection_rate;
}

PointMotion point_motion(const SurfacePoint& point, const dynamics::StateView& state,
                         const std::vector<FrameState>& frames) {
  if (point.frame >= 0) {
    const FrameState& frame = frames[static_cast<std::size_t>(point.frame)];
    const Vec3 rotating = frame.R * point.offset, arm = rotating + point.slide;
    return {frame.pose.translation + arm, frame.twist.at(arm), arm, rotating};
  }
  PointMotion motion{point.offset, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  for (int i = 0; i < point.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    motion.x += point.weight[k] * state.position(point.node[k]);
    motion.v += point.weight[k] * state.velocity(point.node[k]);
  }
  return motion;
}

SampleMotion sample_motion(const ContactSample& sample, const dynamics::StateView& state,
                           const std::vector<FrameState>& frames) {
  SampleMotion motion{point_motion(sample.a, state, frames), point_motion(sample.b, state, frames), 0.0, 0.0};
  motion.gap = sample.normal.dot(motion.a.x - motion.b.x);
  motion.rate = sample.normal.dot(motion.a.v - motion.b.v);
  return motion;
}

// Normal force and regularised Coulomb friction, with the tangential velocity v_t = (I - n n^T)(v_a - v_b):
//   F = A p (n - mu s),   s = v_t / max(|v_t|, v_r)
// Below v_r friction is viscous; above it the friction is mu p A exactly.
Vec3 sample_force(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law) {
  const double p = pressure(law, motion.gap, motion.rate).p;
  if (law.friction == 0.0 || p == 0.0) return sample.area * p * sample.normal;
  return sample.area * p * sample.normal +
         friction_force(law.friction * sample.area * p, sliding_velocity(sample, motion), law.regularisation);
}

// With m = n - mu s, n and A frozen, p = p(gap, rate), gap = n . x_rel, rate = n . v_rel:
//   dF/dx_rel = A p_gap m n^T
//   dF/dv_rel = A (p_rate m n^T - mu p ds/dv_t P),   P = I - n n^T
//   ds/dv_t   = I / v_r                        for |v_t| <= v_r
//             = (I - t t^T) / |v_t|, t = s     beyond
// With a friction spring (friction_anchors.cpp) v_t is replaced by w = v_t + u/tau, and dF/dx_rel has the
// additional term -A mu p ds/dv_t P/tau while the spring is shorter than its maximum. The terms A p_gap mu s
// n^T and A p_rate mu s n^T, by which friction follows the pressure, have no transpose counterpart. Without
// them (`symmetric`) both matrices are symmetric and positive semi-definite: for one step friction is that of
// the pressure at which it was linearised.
//
// Along t friction is constant while the sample slides, and a step of one linear solve takes it as constant:
// it changes the velocity by h mu p A/m, with m the mass that the sample moves, however slowly the sample
// slides. Where |v_t| < h mu p A/m the sliding reverses instead of ending, and again in the next step: |v_t|
// = h mu p A/(2m) back and forth, while friction appears to dissipate m/2 (h mu p A/m)^2 per step, which
// nothing supplies. With the secant through v_t = 0 (`secant_friction`),
//   ds/dv_t = I / max(|v_t|, v_r),      F_t(v) = -A mu p v / max(|v_t|, v_r)      over the step,
// friction opposes the velocity v at the end of the step: F_t . v <= 0 for every h, and a freely sliding mass
// reaches v = v_t / (1 + h mu p A/(m |v_t|)), which has the sign of v_t. The error is |v|/|v_t| - 1 of the
// friction, of first order in h like the step's.
SampleForce sample_force_and_tangent(const ContactSample& sample, const SampleMotion& motion,
                                     const PressureLaw& law, bool symmetric) {
  const Pressure p = pressure(law, motion.gap, motion.rate);
  const Vec3& n = sample.normal;
  if (law.friction == 0.0) {
    const Mat3 nn = sample.area * n * n.transpose();
    return {sample.area * p.p * n, -p.dp_dgap * nn, -p.dp_drate * nn};
  }
  const Vec3 v_t = sliding_velocity(sample, motion);
  const double speed = v_t.norm(), scale = std::max(speed, law.regularisation);
  const Vec3 s = v_t / scale, m = n - law.friction * s;
  const Mat3 P = Mat3::Identity() - n * n.transpose();
  const bool isotropic = law.secant_friction || speed <= law.regularisation;
  const Mat3 ds = isotropic ? Mat3(P / scale) : Mat3((P - s * s.transpose()) / scale);
  const Mat3 mn = sample.area * (symmetric ? n : m) * n.transpose();
  const Mat3 sliding = sample.area * law.friction * p.p * ds;
  Mat3 K = -p.dp_dgap * mn;
  if (law.retardation > 0.0 && sample.deflection_rate.norm() < (1.0 - kLongest) * law.regularisation)
    K += sliding / law.retardation;
  return {sample.area * p.p * m, K, -p.dp_drate * mn + sliding};
}

SampleForce sample_force_and_tangent(const ContactSample& sample, const SampleMotion& motion,
                                     const PressureLaw& law, const FrictionLine& friction) {
  const Pressure p = pressure(law, motion.gap, motion.rate);
  const Vec3& n = sample.normal;
  const Mat3 nn = sample.area * n * n.transpose();
  return {sample.area * p.p * n + friction.constant - friction.D * sliding_velocity(sample, motion),
          -p.dp_dgap * nn, -p.dp_drate * nn + friction.D};
}

// The linear equations may give tension where a contact opens within the step: friction is zero then.
SampleEnd sample_end(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law,
                     const SampleStep& step) {
  const Pressure p = pressure(law, motion.gap, motion.rate);
  const Vec3& n = sample.normal;
  const double end = p.p + p.dp_dgap * n.dot(step.moved) + p.dp_drate * n.dot(step.change);
  const Vec3 change = step.change - n.dot(step.change) * n;
  return {law.friction * sample.area * std::max(end, 0.0), sliding_velocity(sample, motion) + change};
}

Vec3 friction_per_pressure(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law) {
  const Vec3 v_t = sliding_velocity(sample, motion);
  return -sample.area * law.friction / std::max(v_t.norm(), law.regularisation) * v_t;
}

// The spring stores A k S, S' = s; the contact supplies the power -A p delta' to the two surfaces. The
// difference is dissipated:
//   -(A k s delta' - A p delta') = A (p - k s) delta'  =  A d s' delta'^2  or  A 3/2 k c s delta'^2,
// and where the pressure was cut off, -A k s delta' with delta' < 0: all >= 0. Friction takes A mu p w . v_t
// / max(|w|, v_r), which includes the energy that its spring stores and returns.
double damping_power(const PressureLaw& law, double gap, double rate) {
  return (pressure(law, gap, rate).p - law.k * onset(law.onset, -gap).value) * -rate;
}

double sample_dissipation(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law) {
  if (motion.gap >= 0.0) return 0.0;
  const double p = pressure(law, motion.gap, motion.rate).p;
  const Vec3 w = sliding_velocity(sample, motion), v_t = w - sample.deflection_rate;
  return sample.area * (damping_power(law, motion.gap, motion.rate) +
                        law.friction * p * w.dot(v_t) / std::max(w.norm(), law.regularisation));
}

}  // namespace palpate::contact
