#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/keys.h"

namespace palpate {

/// One line of a registry, which maps a name in a scene to a part.  `order` is the theoretical order where
/// there is one, else 0.  `keys` are those of the scene's table that this entry uses and that not every entry
/// of the registry does.
template <class Make>
struct RegistryEntry {
  /// @param its_name, its_summary, its_order, its_make, its_keys  the members of those names
  RegistryEntry(std::string its_name, std::string its_summary, int its_order, Make its_make,
                std::vector<PartKey> its_keys = {})
      : name(std::move(its_name)),
        summary(std::move(its_summary)),
        order(its_order),
        make(std::move(its_make)),
        keys(std::move(its_keys)) {}
  std::string name;           ///< what a scene, the command line and reports call the part
  std::string summary;        ///< one line
  int order;                  ///< theoretical order; 0 where there is none
  Make make;                  ///< makes the part, or describes it
  std::vector<PartKey> keys;  ///< keys of the scene's table that this entry alone uses
};

template <class Make>
/// A registry whose entries have nothing more.
using Registry = std::vector<RegistryEntry<Make>>;

/// A registry is a vector of entries that have a `name`: RegistryEntry, or a struct with more members.
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
