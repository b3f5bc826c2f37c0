#pragma once
#include <memory>

#include "palpate/contact/contact_force.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

struct ToolInstance;

/// Creates the RigidContactSolver objects through which tools with ticks contact obstacles and each other,
/// one per group of tools that meet.
void make_rigid_contact_solver(World& world);

/// Returns the frame of a tool in contact: its block of the State, or its motion over one exchange period.
/// The first call adds it to the World's contact.
std::shared_ptr<contact::MovingFrame> frame_in_contact(World& world, ToolInstance& tool);

/// Returns contact of a tool with an obstacle or another tool; null for other pairs. Ticks use a separate
/// contact in the RigidContactSolver; the returned one, on the bodies' side, follows the paths of the tools
/// and serves energies and pictures.
/// @param spec  its names in canonical order (scene::order_sides)
std::unique_ptr<contact::SampleSource> rigid_source(World& world, const ContactSpec& spec);

}  // namespace palpate::loop
