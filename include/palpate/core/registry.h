#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"

namespace palpate {

/// One line of a registry: a name in a scene becomes a part.
/// `order` is the theoretical order where there is one, else 0.
template <class Make>
struct RegistryEntry {
  std::string name;
  std::string summary;
  int order = 0;
  Make make;
};

template <class Make>
using Registry = std::vector<RegistryEntry<Make>>;

/// A registry is a vector of entries that have a `name`: RegistryEntry, or one with more to tell.
template <class Entry>
std::vector<std::string> names(const std::vector<Entry>& registry) {
  std::vector<std::string> out;
  for (const auto& entry : registry) out.push_back(entry.name);
  return out;
}

/// The entry called `name`; throws Error naming `what` and the nearest known name.
template <class Entry>
const Entry& find(const std::vector<Entry>& registry, std::string_view name, std::string_view what) {
  for (const auto& entry : registry)
    if (entry.name == name) return entry;
  fail("unknown {} \"{}\"{}", what, name, suggestion(name, names(registry)));
}

}  // namespace palpate
