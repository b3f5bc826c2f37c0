#pragma once
#include <string>

#include "palpate/scene/description.h"

namespace palpate::scene {

/// Puts the two names of a contact into canonical order: bodies in the order of the scene, then tools, then
/// obstacles.  So the result is bitwise independent of the order of the names.
void order_sides(const Description& description, ContactSpec& contact);

/// Returns the method of a contact, with "auto" resolved: "image" where `pixels` is given; else "distance"
/// (nearest points); but for spring = "per_point", "analytic" where exact gaps exist, else "image".
/// @pre the names are in canonical order
std::string contact_method(const Description& description, const ContactSpec& contact);

/// Whether a contact is found in images.  @pre its method is resolved
inline bool is_in_images(const ContactSpec& contact) { return contact.method == "image"; }
/// Whether any contact of this body is found in images.
bool is_in_images(const Description& description, const std::string& body);

}  // namespace palpate::scene
