#pragma once
#include <string>
#include <vector>

#include "faults.h"
#include "palpate/contact/sources.h"
#include "palpate/loop/run.h"

/// A rigid body on a rigid slab under gravity, through everything a scene goes through: the tool without its
/// coupling (stiffness and damping zero), in one system with a block whose nodes are all held, whose upper
/// face is the plane z = 0.
namespace palpate::validation {

/// Block `length` x `width`, contact in image space by `backend`, implicit midpoint at 1e-4 s, contact looked
/// for anew every millisecond.  The caller gives the tool its shape, mass and place, the scene its gravity
/// and the contact its law.
scene::Description free_tool_scene(contact::DepthBackend backend, double length, double width);

/// What each tick showed, a millisecond apart.
std::vector<loop::TickRecord> run_free_tool(const scene::Description& description, const Spoiler& spoil = {});

/// Mean acceleration of the tool along x between two times [m/s^2].
double mean_acceleration(const std::vector<loop::TickRecord>& ticks, double from_s, double to_s);

}  // namespace palpate::validation
