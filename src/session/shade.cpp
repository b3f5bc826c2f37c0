#include "session/shade.h"

#include <algorithm>

#include "palpate/core/error.h"
#include "render/available.h"

namespace palpate::session {

Shade check_picture(const std::string& name, const scene::Description& description) {
  render::check_available();
  const std::vector<std::string> known = {"displacement", "stress", "penetration"};
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end()) fail("--shade: unknown \"{}\"{}", name, suggestion(name, known));
  const auto shade = static_cast<Shade>(found - known.begin());
  if (shade == Shade::kPenetration && description.contacts.empty())
    fail("--shade penetration: the scene has no [[contact]]; add one, or choose another shade");
  return shade;
}

bool is_free(const SoftBodySpec& body) {
  return std::none_of(body.attachments.begin(), body.attachments.end(),
                      [](const AttachmentSpec& one) { return one.to.empty() && one.keyframes.empty(); });
}

std::vector<std::string> free_bodies(const scene::Description& description) {
  std::vector<std::string> out;
  for (const SoftBodySpec& body : description.bodies)
    if (is_free(body)) out.push_back(body.name);
  return out;
}

}  // namespace palpate::session
