#pragma once
#include "palpate/loop/world.h"
#include "tool_side.h"

namespace palpate::loop {

/// What one linearly implicit step of the bodies over H needs beside its matrix (linearise.cpp): s and w, the
/// displacements [m] and velocity changes [m/s] that are known beforehand.
void known_motion(World& world, double H, VecX& s, VecX& w);
/// By how much the forces on the nodes change with time as the other tools go on [N/s]; empty: they touch
/// nothing.
VecX rate_by_other_tools(const World& world, const ToolSide& mine);
/// H (f + H rate - K s - D w) - M w on free directions, at the World's state.
/// @param rate  as above
VecX right_hand_side(World& world, double H, const VecX& s, const VecX& w, const VecX& rate);
/// A factor of ToolSide::condensed_matrix, the system's step matrix: by LU where it is indefinite (an
/// inverted element, a compressed strut), null where it is singular.
dynamics::LinearSolver* factored(const dynamics::System& system, ToolSide& side);

}  // namespace palpate::loop
