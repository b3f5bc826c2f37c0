#include "bones/path.h"

#include <utility>

#include "palpate/device/device.h"
#include "palpate/device/keyframes.h"

namespace palpate::bones {

dynamics::Path placed_path(const BoneSpec& spec) {
  const Pose placed{quaternion_of(spec.rotation_vector_rad), spec.position_m};
  if (spec.fixed) return [placed](double) { return dynamics::PathPoint{placed, {}, {}}; };
  return [keyframes = spec.keyframes, placed](double t) {
    const device::HandleSample s = device::sample_keyframes(keyframes, t);
    return dynamics::PathPoint{{s.pose.rotation * placed.rotation, s.pose.translation + placed.translation},
                               s.twist,
                               s.acceleration};
  };
}

// Keyframes give a rotation Q(t), with rate w and its rate a, and a translation d(t), relative to the
// parent's initial pose.  With j the joint and r = Q (o - j), the bone's origin o is at
//     y = j + d + r,   y' = d' + w x r,   y'' = d'' + a x r + w x (w x r).
// Since then the parent has moved from (R0, p0) to (R, p), with twist (W, V) and its rate (A, V'). With T = R
// R0^T and s = T (y - p0):
//     x = p + s,   v = V + W x s + T y',   x'' = V' + A x s + W x (W x s) + 2 W x T y' + T y'',
//     rotation T Q,   angular velocity W + T w,   its rate A + T a + W x T w.
dynamics::Path prescribed_path(const PrescribedJoint& joint, dynamics::Path parent,
                               const Pose& parent_start) {
  return [joint, parent = std::move(parent), parent_start](double t) {
    device::HandleSample s;
    if (!joint.keyframes.empty()) s = device::sample_keyframes(joint.keyframes, t);
    const Quat Q = joint.axes * s.pose.rotation * joint.axes.conjugate();
    const Vec3 r = Q * (joint.start.translation - joint.position), w = joint.axes * s.twist.angular,
               a = joint.axes * s.acceleration.angular;
    const Vec3 y = joint.position + joint.axes * s.pose.translation + r;
    const Vec3 y1 = joint.axes * s.twist.linear + w.cross(r),
               y2 = joint.axes * s.acceleration.linear + a.cross(r) + w.cross(w.cross(r));
    if (!parent) return dynamics::PathPoint{{Q * joint.start.rotation, y}, {w, y1}, {a, y2}};
    const dynamics::PathPoint at = parent(t);
    const Quat T = at.pose.rotation * parent_start.rotation.conjugate();
    const Vec3 from = T * (y - parent_start.translation), &W = at.twist.angular, &A = at.acceleration.angular,
               Tw = T * w, Ty1 = T * y1;
    return dynamics::PathPoint{
        {T * Q * joint.start.rotation, at.pose.translation + from},
        {W + Tw, at.twist.linear + W.cross(from) + Ty1},
        {A + T * a + W.cross(Tw),
         at.acceleration.linear + A.cross(from) + W.cross(W.cross(from)) + 2.0 * W.cross(Ty1) + T * y2}};
  };
}

}  // namespace palpate::bones
