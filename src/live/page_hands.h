#pragma once
#include <memory>
#include <vector>

#include "live/page_device.h"
#include "palpate/scene/description.h"

namespace palpate::live {

/// Devices of the hands that viewers move, in the numbering of scene::hands_of(), and the mailboxes of their
/// targets; both are null for a hand that the scene's device moves.
struct PageHands {
  HandleMailboxes mailboxes;
  std::vector<std::unique_ptr<device::Device>> devices;
};

/// Lets viewers move the first hand, and the others unless they are moved from outside this program: by
/// hardware, or by another process. Handles start at the poses of their tools.
/// @throws Error for an invalid [device]
PageHands page_hands_of(const scene::Description& description);

}  // namespace palpate::live
