#include "palpate/scene/contact_sides.h"

#include <algorithm>
#include <utility>

#include "palpate/scene/hands.h"

namespace palpate::scene {
namespace {

/// Place of a name in the order; behind all others where the scene has nothing of that name.
std::size_t place(const Description& d, const std::string& name) {
  const auto body =
      std::find_if(d.bodies.begin(), d.bodies.end(), [&](const auto& b) { return b.name == name; });
  if (body != d.bodies.end()) return static_cast<std::size_t>(body - d.bodies.begin());
  const std::vector<Hand> hands = hands_of(d);
  const auto hand = std::find_if(hands.begin(), hands.end(), [&](const Hand& h) { return h.name == name; });
  return d.bodies.size() + static_cast<std::size_t>(hand - hands.begin());
}

}  // namespace

void order_sides(const Description& description, ContactSpec& contact) {
  if (place(description, contact.second) < place(description, contact.first))
    std::swap(contact.first, contact.second);
}

}  // namespace palpate::scene
