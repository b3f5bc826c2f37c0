#pragma once
#include <memory>

#include "palpate/contact/contact_force.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

struct ToolSide;

/// Gives tools of ticks what they feel obstacles and each other by: one RigidTouch to all that meet.
void make_rigid_touch(World& world);

/// Returns a tool's frame in contact: its block of the State, or its motion over one exchange period.
std::shared_ptr<contact::MovingFrame> tool_motion(World& world, ToolSide& side);

/// Returns contact of a tool with an obstacle or another tool; null where the names are of something else.
/// Tools of ticks feel one of their own; what the bodies' side knows of it, along the paths that the tools
/// went, is for energies and pictures.
/// @param spec  its names in their order (scene::order_sides)
std::unique_ptr<contact::SampleSource> rigid_source(World& world, const ContactSpec& spec);

}  // namespace palpate::loop
