#pragma once
#include <vector>

#include "contact/friction.h"
#include "palpate/contact/frame.h"
#include "palpate/contact/pressure.h"
#include "palpate/contact/sample.h"

namespace palpate::contact {

/// Frame evaluated at one state.
struct FrameState {
  Pose pose;
  Mat3 R = Mat3::Identity();
  Twist twist;
  int u_offset = -1;
};

/// Position and motion of one side's point.
struct PointMotion {
  Vec3 x, v;      ///< Position [m], velocity of the material there [m/s].
  Vec3 arm;       ///< Frames: vector from the frame's origin [m], world axes.
  Vec3 rotating;  ///< Part of the arm that rotates with the frame, arm - slide.
};

/// Both points of a sample, their gap [m] and its rate [m/s].
struct SampleMotion {
  PointMotion a, b;
  double gap, rate;
};

/// Force on point a, and its derivatives with respect to x_a - x_b and v_a - v_b.
struct SampleForce {
  Vec3 force;  ///< Force [N].
  Mat3 K, D;   ///< -dF/dx_rel [N/m], -dF/dv_rel [N s/m]
};

/// Evaluates one side's point at a state.
PointMotion point_motion(const SurfacePoint& point, const dynamics::StateView& state,
                         const std::vector<FrameState>& frames);
/// Evaluates both points, the gap and its rate at a state.
SampleMotion sample_motion(const ContactSample& sample, const dynamics::StateView& state,
                           const std::vector<FrameState>& frames);

/// Returns the force on point a [N].
Vec3 sample_force(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law);
/// Returns the force and its derivatives.
/// @param symmetric  K and D without the change of friction with pressure: symmetric, positive semi-definite
SampleForce sample_force_and_tangent(const ContactSample& sample, const SampleMotion& motion,
                                     const PressureLaw& law, bool symmetric = false);
/// Returns the tangential part of v_a - v_b plus the contribution of the friction spring [m/s].
Vec3 sliding_velocity(const ContactSample& sample, const SampleMotion& motion);
/// Returns the force and its derivatives with friction from an affine law at the sample's velocity;
/// symmetric, positive semi-definite.
SampleForce sample_force_and_tangent(const ContactSample& sample, const SampleMotion& motion,
                                     const PressureLaw& law, const FrictionLine& friction);
/// Motion of a sample within a step, relative to its motion at the step's start.
struct SampleStep {
  Vec3 moved = Vec3::Zero();   ///< Displacement of x_a - x_b [m].
  Vec3 change = Vec3::Zero();  ///< Change of v_a - v_b [m/s].
};
/// Step's end by its linear equations: mu times the normal force, and the sliding velocity.
struct SampleEnd {
  double limit;  ///< mu times the normal force [N].
  Vec3 v;        ///< Sliding velocity [m/s].
};
/// Returns the limit of friction and the sliding velocity at the step's end.
SampleEnd sample_end(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law,
                     const SampleStep& step);
/// Returns the friction per pressure: -A mu s [m^2].
Vec3 friction_per_pressure(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law);
/// Returns the power per area dissipated by the damping of a touching contact [W/m^2], >= 0.
double damping_power(const PressureLaw& law, double gap, double rate);
/// Returns the power dissipated by damping and friction [W]; >= 0 except for the energy returned by friction
/// springs.
double sample_dissipation(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law);

}  // namespace palpate::contact
