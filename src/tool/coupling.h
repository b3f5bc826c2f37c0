#pragma once
#include "palpate/core/pose.h"
#include "palpate/dynamics/exchange.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/tool/spec.h"

namespace palpate::tool {

/// Virtual coupling of Colgate et al. (1995): a spring-damper in each of the six directions, between the
/// origins of handle and tool.
struct CouplingGains {
  double k = 0.0, b = 0.0;      ///< translation [N/m, N s/m]
  double k_r = 0.0, b_r = 0.0;  ///< rotation [N m/rad, N m s/rad]
};
CouplingGains coupling_gains(const ToolSpec& spec);

using dynamics::RigidMotion;

Vec6 stacked(const Twist& twist);
Twist twist_of(const Vec6& v);
Wrench wrench_of(const Vec6& w);

/// (moment about the tool's origin, force) that the coupling exerts on the tool [N m, N].  With d the
/// rotation vector from tool to handle:
///     moment = k_r d + b_r (omega_h - omega_t),   force = k (x_h - x_t) + b (v_h - v_t).
/// d jumps at 180 degrees: there the moment is bounded, but changes its side.
Vec6 coupling_wrench(const CouplingGains& gains, const RigidMotion& tool, const RigidMotion& handle);

/// K = -dF/dx along the tool's world-axes increments (angular, linear), exact; unsymmetric where tool and
/// handle are rotated against each other.  B = -dF/dv is diag(b_r, b).
Mat6 coupling_stiffness(const CouplingGains& gains, const Pose& tool, const Pose& handle);
Mat6 coupling_damping(const CouplingGains& gains);

/// 1/2 k |x_h - x_t|^2 + 1/2 k_r |d|^2 [J]
double coupling_energy(const CouplingGains& gains, const Pose& tool, const Pose& handle);
/// b |v_h - v_t|^2 + b_r |omega_h - omega_t|^2 >= 0 [W]
double coupling_dissipation(const CouplingGains& gains, const Twist& tool, const Twist& handle);

/// K = -dF/dx of a contact record at a pose (the record is linear in the rotation vector from its own pose,
/// so K follows that vector's derivative).
Mat6 contact_stiffness(const dynamics::LinearisedContact& record, const Pose& tool);
/// B = -dF/dv of a contact record.
Mat6 contact_damping(const dynamics::LinearisedContact& record);

}  // namespace palpate::tool
