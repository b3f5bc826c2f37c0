#include "live/page_hands.h"

#include <filesystem>

#include "palpate/device/registry.h"
#include "palpate/scene/hands.h"

namespace palpate::live {
namespace {

/// Returns whether the device is moved from outside. It is built for that and not opened; a recording is not
/// read.
bool is_live(const DeviceSpec& spec, const std::string& folder) {
  return spec.type != "recording" && device::make_device(spec, folder)->is_live();
}

}  // namespace

PageHands page_hands_of(const scene::Description& description) {
  const std::string folder = std::filesystem::path(description.path).parent_path().string();
  PageHands out;
  for (const scene::Hand& hand : scene::hands_of(description)) {
    if (!out.devices.empty() && is_live(*hand.device, folder)) {
      out.mailboxes.push_back(nullptr);
      out.devices.push_back(nullptr);
      continue;
    }
    out.mailboxes.push_back(std::make_shared<HandleMailbox>());
    out.devices.push_back(std::make_unique<PageDevice>(
        out.mailboxes.back(), Pose{quaternion_of(hand.tool->rotation_vector_rad), hand.tool->position_m}));
  }
  return out;
}

}  // namespace palpate::live
