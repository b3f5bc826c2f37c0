#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/keys.h"

namespace palpate {

/// Entry of a registry, which maps a name in a scene to a part.  `order` is the theoretical order, or 0 where
/// the notion does not apply.  `keys` lists the keys of the scene's table that this entry uses and some other
/// entries of the registry do not.
template <class Make>
struct RegistryEntry {
  /// Builds the entry.
  /// @param its_name, its_summary, its_order, its_make, its_keys  the members of those names
  RegistryEntry(std::string its_name, std::string its_summary, int its_order, Make its_make,
                std::vector<PartKey> its_keys = {})
      : name(std::move(its_name)),
        summary(std::move(its_summary)),
        order(its_order),
        make(std::move(its_make)),
        keys(std::move(its_keys)) {}
  std::string name;           ///< Name of the part in scenes, on the command line and in reports.
  std::string summary;        ///< Description of one line.
  int order;                  ///< Theoretical order; 0 where there is none.
  Make make;                  ///< Builds or describes the part.
  std::vector<PartKey> keys;  ///< Keys of the scene's table that not every entry uses.
};

template <class Make>
/// Registry whose entries have no further members.
using Registry = std::vector<RegistryEntry<Make>>;

/// Returns the names of a registry: a vector of RegistryEntry, or of any struct with a member `name`.
template <class Entry>
std::vector<std::string> names(const std::vector<Entry>& registry) {
  std::vector<std::string> out;
  for (const auto& entry : registry) out.push_back(entry.name);
  return out;
}

/// Returns the entry called `name`.  @throws Error that mentions `what` and the nearest known name
template <class Entry>
const Entry& find(const std::vector<Entry>& registry, std::string_view name, std::string_view what) {
  for (const auto& entry : registry)
    if (entry.name == name) return entry;
  fail("unknown {} \"{}\"{}", what, name, suggestion(name, names(registry)));
}

}  // namespace palpate
