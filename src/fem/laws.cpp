#include "palpate/fem/laws.h"

#include "law.h"
#include "law_list.h"

namespace palpate::fem {

namespace laws {
#define PALPATE_LAW(name) extern const Law name;
PALPATE_LAWS(PALPATE_LAW)
#undef PALPATE_LAW
}  // namespace laws

const Registry<const Law*>& law_registry() {
#define PALPATE_LAW(name) {#name, laws::name.summary, 0, &laws::name},
  static const Registry<const Law*> registry{PALPATE_LAWS(PALPATE_LAW)};
#undef PALPATE_LAW
  return registry;
}

std::size_t find_law(const std::string& name, std::string_view where) {
  const auto& registry = law_registry();
  for (std::size_t i = 0; i < registry.size(); ++i)
    if (registry[i].name == name) return i;
  fail("{}: unknown law \"{}\"{}", where, name, suggestion(name, names(registry)));
}

void check_law(const std::string& name, Tangent tangent, bool nodal_dilatation, const std::string& where) {
  const Law& law = *law_registry()[find_law(name, where)].make;
  if (tangent == Tangent::kWarped && !law.warped)
    fail("{}: tangent = \"warped\" is not available for law = \"{}\"; use \"exact\" or \"projected\"", where,
         name);
  if (nodal_dilatation && !law.nodal_dilatation)
    fail(
        "{}: volumetric = \"nodal\" is not available for law = \"{}\"; use \"element\", with "
        "poissons_ratio up to 0.45 to avoid locking, or law = \"corotational\"",
        where, name);
}

}  // namespace palpate::fem
