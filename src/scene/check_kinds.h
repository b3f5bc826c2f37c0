#pragma once
#include "palpate/scene/kinds.h"
#include "scene/document.h"

namespace palpate::scene {

/// A key of the file that is not for what an override put in its kind's place.
struct LeftKey {
  std::string table, key;  ///< "contact[1]", "pixels"
};

/// Refuses names that `kinds` does not know, and keys that the chosen kinds have no use for, lack or do not
/// take the value of.  @return keys of the file's own kinds, where overrides chose others
std::vector<LeftKey> check_kinds(const Document& document, const Description& description,
                                 const Kinds& kinds);

}  // namespace palpate::scene
