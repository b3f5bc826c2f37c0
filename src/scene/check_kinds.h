#pragma once
#include "palpate/scene/kinds.h"
#include "scene/document.h"

namespace palpate::scene {

/// Key of the file that does not apply to the kind chosen by an override.
struct DroppedKey {
  std::string table, key;  ///< "contact[1]", "pixels"
};

/// Gives each table the values of the kind that it selects (Kind::values), where the table does not have the
/// key.
void fill_in_values(Document& document, const Kinds& kinds);

/// Rejects names that `kinds` does not contain, and keys that do not apply to the chosen kinds, are missing,
/// or have a bad value.  @return keys that apply to the file's kinds only, where overrides chose others
std::vector<DroppedKey> check_kinds(const Document& document, const Description& description,
                                    const Kinds& kinds);

}  // namespace palpate::scene
