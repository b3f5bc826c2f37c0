#pragma once
#include <set>

#include "palpate/loop/world.h"

/// Nodes of a body that do not move freely, for pictures.
namespace palpate::loop {

/// Returns the nodes of a body that are fixed, driven, or carried by a bone, in any direction.
/// @param body  index in world.bodies
std::set<int> driven_nodes(const World& world, std::size_t body);

/// Returns the nodes that attachments of the body to a bone or a tool select by a box or a sphere.
/// @param body  index in world.bodies
std::set<int> carried_nodes(const World& world, std::size_t body);

}  // namespace palpate::loop
