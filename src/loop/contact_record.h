#pragma once
#include <type_traits>

#include "contact/reduced_contact_model.h"
#include "palpate/dynamics/linearised_contact.h"

namespace palpate::loop {

/// Contact data sent from the bodies to the tool's ticks at an exchange.
struct ContactRecord {
  /// Linear contact; with source = kPoints only its time, pose and twist are used.
  dynamics::LinearisedContact linear;
  contact::ReducedContactModel
      touch;  ///< For source = kPoints: reduced model from which ticks compute their contact.
};
static_assert(std::is_trivially_copyable_v<ContactRecord>);

}  // namespace palpate::loop
