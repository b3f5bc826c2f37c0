#pragma once
#include <functional>
#include <string>

#include "palpate/device/device.h"
#include "palpate/loop/world.h"
#include "palpate/scene/hands.h"

/// Steps of assemble(), one file each.
namespace palpate::loop {

/// Calls `make`, which builds the part for the table `at` of the scene, such as "body[1]". If it throws an
/// Error whose message does not begin with a file, the location of the table is put in front:
/// `scene.toml:12:1: body "liver": ...`.
/// @param who  `body "liver"`, inserted unless the message begins with it; may be empty
void at_place(const World& world, const std::string& at, const std::string& who,
              const std::function<void()>& make);

void assemble_bodies(World& world);
/// Assembles the regions of a body and the material index of each element, and returns the list of materials,
/// beginning with the body's.
/// @param in_file  regions of its mesh file  @pre body.placed is set
fem::Materials assemble_materials(const SoftBodySpec& spec, std::vector<MaterialRegion> in_file, Body& body);
void assemble_bones(World& world);      ///< For [[bone]].
void assemble_skeletons(World& world);  ///< Bones of model files, if [body.skeleton] enables them.
/// Assembles the tool of one hand; tools of the monolithic scheme become blocks of the State.
/// @param device  replaces the scene's device; null: the scene's
ToolInstance assemble_tool(World& world, const scene::Hand& hand, std::unique_ptr<device::Device> device);
void assemble_attachments(World& world);  ///< After all parts that nodes may be attached to.
/// Returns the default speed below which friction of a tool is viscous, if the scene specifies none [m/s].
double tool_friction_speed(const World& world, const ToolSpec& tool);
/// Sets the default of a contact's regularisation speed, if the scene specifies none.
void set_friction_speed(World& world, ContactSpec& contact);
/// Returns the retardation time of the springs that model sticking (contact/friction_anchors.cpp); 0: none
/// [s].
double friction_retardation(const scene::Description& description, const ContactSpec& contact);
void assemble_contact(World& world);  ///< For [[contact]], or if a tool with ticks carries nodes.

}  // namespace palpate::loop
