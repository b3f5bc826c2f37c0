#pragma once
#include "tool/rigid_block.h"

/// A simulated hand of [device] as one block of the State, in continuous time, without sampling. Monolithic
/// solutions with this hand are the reference for the sampled haptic loop.
namespace palpate::tool {

/// Equation of motion of the hand, three translations and three rotations with one law each; x is a position
/// or an angle and F the wrench of the virtual coupling:
///     m x'' = k (x_d - x) + b (x_d' - x') - c x' - f x'/sqrt(x'^2 + v_r^2) + F.
/// Coulomb friction is smoothed below v_r = 1e-5 m/s and 1e-4 rad/s.
struct HandBlock {
  /// Parameters of one kind of axes.
  struct Axis {
    double mass = 1.0;         ///< m > 0 [kg; kg m^2]
    double stiffness = 0.0;    ///< k of the arm [N/m; N m/rad]
    double arm_damping = 0.0;  ///< b of the arm [N s/m; N m s/rad]
    double damping = 0.0;      ///< c of the device
    double friction = 0.0;     ///< f of the device [N; N m]
  };
  Axis translation, rotation;
  HandlePath requested;  ///< Target motion x_d; orientations within half a turn of the first.
};

/// Returns the block of the hand: q = (theta, position), u = q', theta the rotation vector from the first
/// target orientation.
/// @param length, speed  characteristic scales for error control [m, m/s]
dynamics::BlockSpec hand_block(double length, double speed);
/// Returns q at the start: at rest at the first target pose.
VecX hand_at_start(const HandBlock& hand);
/// Returns pose and twist of the handle in a state.
HandleState hand_motion(const dynamics::StateView& state, int hand_id, const HandBlock& hand);

/// Terms of the equation of motion of the hand.
struct HandTerms {
  std::shared_ptr<dynamics::InertiaTerm> inertia;
  std::shared_ptr<dynamics::ForceTerm> arm;  ///< Arm, and friction of the device.
  /// Virtual coupling to the tool, with its exact, unsymmetric tangent.
  std::shared_ptr<dynamics::ForceTerm> coupling;
};
/// Builds the terms of a hand that is coupled to a tool.
/// @param tool_id  a rigid_block of the State
HandTerms make_hand_terms(int hand_id, int tool_id, const ToolSpec& spec, const HandBlock& hand);

}  // namespace palpate::tool
