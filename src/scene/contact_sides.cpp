#include "palpate/scene/contact_sides.h"

#include <algorithm>
#include <utility>

namespace palpate::scene {
namespace {

/// Place of a name in the order; behind all others where the scene has nothing of that name.
std::size_t place(const Description& d, const std::string& name) {
  const auto body =
      std::find_if(d.bodies.begin(), d.bodies.end(), [&](const auto& b) { return b.name == name; });
  if (body != d.bodies.end()) return static_cast<std::size_t>(body - d.bodies.begin());
  return d.bodies.size() + (d.tool && name == "tool" ? 0 : 1);
}

}  // namespace

void order_sides(const Description& description, ContactSpec& contact) {
  if (place(description, contact.second) < place(description, contact.first))
    std::swap(contact.first, contact.second);
}

}  // namespace palpate::scene
