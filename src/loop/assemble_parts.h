#pragma once
#include <functional>
#include <string>

#include "palpate/loop/world.h"

/// The steps of assemble(), one file each.
namespace palpate::loop {

/// Runs `make`, which is about the table `at` of the scene, "body[1]".  An Error of it that begins with no
/// file gets the table's place in front: `scene.toml:12:1: body "liver": ...`.
/// @param who  `body "liver"`, put there where the message does not begin with it; may be empty
void at_place(const World& world, const std::string& at, const std::string& who,
              const std::function<void()>& make);

void assemble_bodies(World& world);
/// The regions of a body and the number of each element's material; then the list of materials, the body's
/// own first.
/// @param in_file  regions of its mesh file  @pre body.placed
fem::Materials assemble_materials(const SoftBodySpec& spec, std::vector<MaterialRegion> in_file, Body& body);
void assemble_bones(World& world);      ///< only with [[bone]]
void assemble_skeletons(World& world);  ///< bones of model files, where a [body.skeleton] asks for them
void assemble_tool(World& world, std::size_t hand);  ///< for each of scene::hands_of()
void assemble_attachments(World& world);             ///< after all that nodes may be attached to
/// Returns the speed below which friction of that tool is viscous, where a scene names none [m/s].
double tool_friction_speed(const World& world, const ToolSpec& tool);
/// Sets that of a contact, where the scene names none.
void set_friction_speed(World& world, ContactSpec& contact);
/// Returns the retardation time of the springs that hold what sticks (contact/friction_anchors.cpp); 0: there
/// are none [s].
double friction_retardation(const scene::Description& description, const ContactSpec& contact);
void assemble_contact(World& world);  ///< only with [[contact]], or where a tool of ticks carries nodes

}  // namespace palpate::loop
