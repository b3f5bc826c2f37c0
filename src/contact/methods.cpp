#include "palpate/contact/methods.h"

#include <fmt/ranges.h>

namespace palpate::contact {

const std::vector<MethodEntry>& method_registry() {
  static const std::vector<MethodEntry> registry = {
      {"analytic", "exact gaps at the vertices: of obstacles, and of tools with shape = \"sphere\"", {}},
      {"auto", "\"distance\"; \"image\" where pixels are given", part_keys({"pixels", "quadrature_error"})},
      {"distance",
       "material points of skins and their nearest points on what they touch: the gradient of an energy, "
       "continuous; of soft bodies, themselves too, tools of any shape and obstacles",
       part_keys({"quadrature_error"})},
      {"image",
       "depths in image space as Galoppo et al. (2007) have them, at the vertices of soft bodies: tools of "
       "any shape, other soft bodies; by OpenGL, without a GPU by Mesa's software rasteriser",
       part_keys({"pixels"})},
  };
  return registry;
}

const std::vector<AbsentMethod>& absent_methods() {
  static const std::vector<AbsentMethod> absent = {
      {"cpu", "has been removed; write \"distance\", or \"image\""},
      {"gpu", "is now \"image\""},
      {"exact", "has been removed; write \"distance\""},
      {"vertex", "is no method; \"analytic\" and \"image\" have their samples at vertices"},
      {"pixel", "is no method; write \"image\""},
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
