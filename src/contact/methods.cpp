#include "palpate/contact/methods.h"

#include <fmt/ranges.h>

namespace palpate::contact {

const std::vector<MethodEntry>& method_registry() {
  static const std::vector<MethodEntry> registry = {
      {"analytic", "exact gaps at the vertices: of obstacles, and of tools with shape = \"sphere\""},
      {"gpu",
       "image space: gaps at the pixels of an image; tools of any shape, other soft bodies, a body "
       "against itself",
       part_keys({"pixels"})},
  };
  return registry;
}

const std::vector<AbsentMethod>& absent_methods() {
  static const std::vector<AbsentMethod> absent = {
      {"vertex",
       "is not there yet; take method = \"analytic\" for an obstacle or a sphere (it samples at the "
       "vertices), \"gpu\" for a tool of another shape or a soft body"},
      {"cpu",
       "is not there yet; take method = \"gpu\", which runs on a processor as well, by Mesa's software "
       "rasteriser"},
      {"exact",
       "is not there yet; take method = \"analytic\" for an obstacle or a sphere, whose gaps are "
       "exact, \"gpu\" for a tool of another shape or a soft body"},
      {"pixel", "is not known; take method = \"gpu\", which samples at the pixels of an image"},
  };
  return absent;
}

void check_method(const std::string& method, const std::string& where) {
  const auto known = names(method_registry());
  for (const AbsentMethod& one : absent_methods())
    if (one.name == method)
      fail("{}: method = \"{}\" {} (known: {})", where, method, one.answer, fmt::join(known, ", "));
  for (const std::string& name : known)
    if (name == method) return;
  fail("{}: method = \"{}\" is not known{}", where, method, suggestion(method, known));
}

}  // namespace palpate::contact
