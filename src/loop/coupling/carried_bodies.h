#pragma once
#include <vector>

#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/dynamics/state.h"

namespace palpate::loop {

/// Moves the bodies that a tool with ticks carries rigidly with it, over a time in which the bodies are held:
/// their positions and velocities relative to the tool do not change. If a body is held elsewhere, too, the
/// next step returns the held nodes.
/// @param ties  ties of nodes to the tool  @param before  motion of the tool at the State's time
/// @param now  its motion after that time
void carry_along(dynamics::State& state, const std::vector<contact::Tie>& ties,
                 const dynamics::RigidMotion& before, const dynamics::RigidMotion& now);

}  // namespace palpate::loop
