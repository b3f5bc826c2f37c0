#pragma once
#include "palpate/loop/world.h"
#include "tool_instance.h"

namespace palpate::loop {

/// Computes the prescribed part of one linearly implicit step of the bodies over H (linearise.cpp):
/// displacements s [m] and velocity changes w [m/s].
void known_motion(World& world, double H, VecX& s, VecX& w);
/// Returns the rate of change of the nodal forces due to the motion of the other tools [N/s]; empty without
/// contact.
VecX rate_by_other_tools(const World& world, const ToolInstance& mine);
/// Returns H (f + H rate - K s - D w) - M w on free directions, at the World's state.
/// @param rate  from rate_by_other_tools()
VecX right_hand_side(World& world, double H, const VecX& s, const VecX& w, const VecX& rate);
/// Factors ToolInstance::condensed_matrix, the system's step matrix; by LU if it is indefinite (an inverted
/// element, a compressed strut). Returns null if it is singular.
dynamics::LinearSolver* factored(const dynamics::System& system, ToolInstance& side);

}  // namespace palpate::loop
