#include "scene/contact_sides.h"

#include <algorithm>
#include <utility>

#include "palpate/scene/hands.h"

namespace palpate::scene {
namespace {

/// Returns the rank of a name in the canonical order; greatest where the name is neither a body nor a tool.
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

bool is_in_images(const Description& description, const std::string& body) {
  return std::any_of(description.contacts.begin(), description.contacts.end(), [&](ContactSpec contact) {
    if (contact.first != body && contact.second != body) return false;
    order_sides(description, contact);
    contact.method = contact_method(description, contact);
    return is_in_images(contact);
  });
}

std::string contact_method(const Description& description, const ContactSpec& contact) {
  if (contact.method != "auto") return contact.method;
  const ContactSpec none;
  if (contact.pixels != none.pixels) return "image";
  if (contact.spring != "per_point") return "distance";
  const auto is_named = [&](const auto& one) { return one.name == contact.second; };
  const ToolSpec* tool = tool_named(description, contact.second);
  const bool is_exact = (tool && tool->shape == ToolShape::kSphere) ||
                        std::any_of(description.obstacles.begin(), description.obstacles.end(), is_named);
  return is_exact ? "analytic" : "image";
}

}  // namespace palpate::scene
