#pragma once
#include <vector>

#include "contact/friction.h"
#include "contact/pressure.h"
#include "palpate/contact/frame.h"
#include "palpate/contact/sample.h"

namespace palpate::contact {

/// A frame at the state of one evaluation.
struct FrameState {
  Pose pose;
  Mat3 R = Mat3::Identity();
  Twist twist;
  int u_offset = -1;
};

/// Where one side's point is and how it moves.
struct PointMotion {
  Vec3 x, v;      ///< position [m], velocity of the material there [m/s]
  Vec3 arm;       ///< frames: from the frame's origin [m], world axes
  Vec3 rotating;  ///< the part of it that rotates with the frame, arm - slide
};

/// Both points of a sample, their gap and its rate.
struct SampleMotion {
  PointMotion a, b;
  double gap, rate;
};

/// The force on point a, and its derivatives by x_a - x_b and v_a - v_b.
struct SampleForce {
  Vec3 force;  ///< [N]
  Mat3 K, D;   ///< -dF/dx_rel [N/m], -dF/dv_rel [N s/m]
};

PointMotion point_motion(const SurfacePoint& point, const dynamics::StateView& state,
                         const std::vector<FrameState>& frames);
SampleMotion sample_motion(const ContactSample& sample, const dynamics::StateView& state,
                           const std::vector<FrameState>& frames);

Vec3 sample_force(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law);
/// @param symmetric  K and D without the change of friction by pressure: symmetric, positive semi-definite
SampleForce sample_force_and_tangent(const ContactSample& sample, const SampleMotion& motion,
                                     const PressureLaw& law, bool symmetric = false);
/// Tangential part of v_a - v_b, and what friction's spring adds to it [m/s].
Vec3 sliding_velocity(const ContactSample& sample, const SampleMotion& motion);
/// Force and its derivatives with friction as that line gives it at the sample's own velocity; symmetric,
/// positive semi-definite.
SampleForce sample_force_and_tangent(const ContactSample& sample, const SampleMotion& motion,
                                     const PressureLaw& law, const FrictionLine& friction);
/// How a sample moves within a step, from its motion at the step's start.
struct SampleStep {
  Vec3 moved = Vec3::Zero();   ///< of x_a - x_b [m]
  Vec3 change = Vec3::Zero();  ///< of v_a - v_b [m/s]
};
/// The step's end as its linear equations have it: mu times the normal force, and the sliding velocity.
struct SampleEnd {
  double limit;  ///< [N]
  Vec3 v;        ///< [m/s]
};
SampleEnd sample_end(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law,
                     const SampleStep& step);
/// The part of the force that friction is, over the pressure: -A mu s [m^2].
Vec3 friction_per_pressure(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law);
/// Power per area that damping takes out of a touching contact [W/m^2], >= 0.
double damping_power(const PressureLaw& law, double gap, double rate);
/// Power that damping and friction take out [W]; >= 0 but for what friction's springs give back.
double sample_dissipation(const ContactSample& sample, const SampleMotion& motion, const PressureLaw& law);

}  // namespace palpate::contact
