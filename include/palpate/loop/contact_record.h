#pragma once
#include <type_traits>

#include "palpate/contact/touch_model.h"
#include "palpate/dynamics/exchange.h"

namespace palpate::loop {

/// What the bodies tell the tool's ticks at an exchange.
struct ContactRecord {
  /// the contact as it is now; with source = kPoints that of a tool that bodies do not answer
  dynamics::LinearisedContact linear;
  contact::TouchModel touch;  ///< source = kPoints: what ticks make their contact from
};
static_assert(std::is_trivially_copyable_v<ContactRecord>);

}  // namespace palpate::loop
