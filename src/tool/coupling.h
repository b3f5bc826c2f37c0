#pragma once
#include "palpate/core/pose.h"
#include "palpate/dynamics/linearised_contact.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/tool/spec.h"

namespace palpate::tool {

/// Gains of the virtual coupling of Colgate et al. (1995): a spring-damper in each of six directions between
/// the origins of handle and tool.
struct CouplingGains {
  double k = 0.0, b = 0.0;      ///< translation [N/m, N s/m]
  double k_r = 0.0, b_r = 0.0;  ///< rotation [N m/rad, N m s/rad]
};
/// Returns the gains of a tool's spec.
CouplingGains coupling_gains(const ToolSpec& spec);

using dynamics::RigidMotion;

/// Returns (angular, linear).
Vec6 stacked(const Twist& twist);
Twist twist_of(const Vec6& v);
Wrench wrench_of(const Vec6& w);

/// Returns the wrench of the coupling on the tool: (moment about the tool's origin, force) [N m, N]. With d
/// the rotation vector from tool to handle:
///     moment = k_r d + b_r (omega_h - omega_t),   force = k (x_h - x_t) + b (v_h - v_t).
/// d jumps at 180 degrees: the moment is bounded there, but changes its sign.
Vec6 coupling_wrench(const CouplingGains& gains, const RigidMotion& tool, const RigidMotion& handle);

/// Returns K = -dF/dx along the tool's increments (angular, linear) in world axes; exact, and unsymmetric if
/// tool and handle have different orientations.
Mat6 coupling_stiffness(const CouplingGains& gains, const Pose& tool, const Pose& handle);
/// Returns B = -dF/dv = diag(b_r, b).
Mat6 coupling_damping(const CouplingGains& gains);

/// Returns the stored energy, 1/2 k |x_h - x_t|^2 + 1/2 k_r |d|^2 [J].
double coupling_energy(const CouplingGains& gains, const Pose& tool, const Pose& handle);
/// Returns the dissipated power, b |v_h - v_t|^2 + b_r |omega_h - omega_t|^2 >= 0 [W].
double coupling_dissipation(const CouplingGains& gains, const Twist& tool, const Twist& handle);

/// Returns K = -dF/dx of a contact record at a pose. The record is linear in the rotation vector from its
/// reference pose, so K includes the derivative of that vector.
Mat6 contact_stiffness(const dynamics::LinearisedContact& record, const Pose& tool);
/// Returns B = -dF/dv of a contact record.
Mat6 contact_damping(const dynamics::LinearisedContact& record);

}  // namespace palpate::tool
