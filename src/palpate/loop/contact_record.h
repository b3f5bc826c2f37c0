#pragma once
#include <type_traits>

#include "palpate/contact/touch_model.h"
#include "palpate/dynamics/exchange.h"

namespace palpate::loop {

/// What the bodies tell the tool's ticks at an exchange.
struct ContactRecord {
  /// with source = kPoints its instant, pose and twist alone
  dynamics::LinearisedContact linear;
  contact::TouchModel touch;  ///< of source = kPoints: what ticks make their contact from
};
static_assert(std::is_trivially_copyable_v<ContactRecord>);

}  // namespace palpate::loop
