#pragma once
#include "palpate/scene/description.h"

namespace palpate::scene {

/// Puts the two names of a contact into their order: bodies as the scene lists them, then tools, then
/// obstacles.  So the result does not depend on which is named first, to the last bit.
void order_sides(const Description& description, ContactSpec& contact);

/// Default of quadrature_error where points are summed up, not pixels: one per cent, of a force that mesh and
/// stiffness know less well.
inline constexpr double kPointsError = 1e-2;

/// Whether a contact is seen in images: by all methods but those with exact gaps.
inline bool is_in_images(const ContactSpec& contact) {
  return contact.method != "analytic" && contact.method != "distance";
}

}  // namespace palpate::scene
