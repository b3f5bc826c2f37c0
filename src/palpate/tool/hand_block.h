#pragma once
#include "palpate/tool/rigid_block.h"

/// A hand that yields to the tool, as a block of the State beside it: what a simulated hand of [device] is
/// where nothing is sampled.  The truth that its loop of ticks is measured against.
namespace palpate::tool {

/// Six axes with the same law in three, x a position or an angle:
///     m x'' = k (x_d - x) + b (x_d' - x') - c x' - f x'/sqrt(x'^2 + v_r^2) + what the coupling gives;
/// Coulomb's friction is smoothed below v_r = 1e-5 m/s and 1e-4 rad/s.
struct HandBlock {
  struct Axis {
    double mass = 1.0;         ///< m > 0 [kg; kg m^2]
    double stiffness = 0.0;    ///< k of the arm
    double arm_damping = 0.0;  ///< b
    double damping = 0.0;      ///< c of the device
    double friction = 0.0;     ///< f of the device
  };
  Axis translation, rotation;
  HandlePath wanted;  ///< x_d; within half a turn of its first orientation
};

/// q = (theta, position), u = q': theta the rotation vector from the first orientation that is wanted.
/// @param length, speed  sizes that matter to error control [m, m/s]
dynamics::BlockSpec hand_block(double length, double speed);
/// At rest where it wants to be at the start.
VecX hand_at_start(const HandBlock& hand);
HandleState hand_motion(const dynamics::StateView& state, int hand_id, const HandBlock& hand);

struct HandTerms {
  std::shared_ptr<dynamics::InertiaTerm> inertia;
  std::shared_ptr<dynamics::ForceTerm> arm;       ///< with the device's friction
  std::shared_ptr<dynamics::ForceTerm> coupling;  ///< to the tool; with its exact, unsymmetric tangent
};
/// @param tool_id  a rigid_block of the State
HandTerms make_hand_terms(int hand_id, int tool_id, const ToolSpec& spec, const HandBlock& hand);

}  // namespace palpate::tool
