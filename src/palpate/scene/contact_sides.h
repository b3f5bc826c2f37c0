#pragma once
#include <string>

#include "palpate/scene/description.h"

namespace palpate::scene {

/// Puts the two names of a contact into their order: bodies as the scene lists them, then tools, then
/// obstacles.  So the result does not depend on which is named first, to the last bit.
void order_sides(const Description& description, ContactSpec& contact);

/// Returns the method of a contact, with "auto" resolved: nearest points; an image where its keys ask for
/// one; with a spring at each vertex exact gaps where there are any, else an image.
/// @pre the names are in their order
std::string contact_method(const Description& description, const ContactSpec& contact);

/// Whether a contact is found in images.  @pre its method is resolved
inline bool is_in_images(const ContactSpec& contact) { return contact.method == "image"; }
/// Whether a contact of this body is.
bool is_in_images(const Description& description, const std::string& body);

}  // namespace palpate::scene
