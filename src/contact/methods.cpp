#include "palpate/contact/methods.h"

#include <fmt/ranges.h>

namespace palpate::contact {

const std::vector<MethodEntry>& method_registry() {
  static const std::vector<MethodEntry> registry = {
      {"analytic", "exact gaps at the vertices: of obstacles, and of tools with shape = \"sphere\""},
      {"auto",
       "exact gaps where there are any; else image space, on a GPU where the machine has one, else on the "
       "processor",
       part_keys({"pixels", "quadrature_error"})},
      {"cpu",
       "image space on the processor: gaps at the pixels of an image; tools of any shape, other soft bodies, "
       "a "
       "body against itself",
       part_keys({"pixels", "quadrature_error"})},
      {"gpu", "the same image by OpenGL, without a GPU by Mesa's software rasteriser",
       part_keys({"pixels", "quadrature_error"})},
      {"exact",
       "the same pixels without an image: a line through each, in double, and all layers that it meets; slow",
       part_keys({"pixels", "quadrature_error"})},
  };
  return registry;
}

const std::vector<AbsentMethod>& absent_methods() {
  static const std::vector<AbsentMethod> absent = {
      {"vertex",
       "is not there yet; take method = \"analytic\" for an obstacle or a sphere (it samples at the "
       "vertices), \"auto\" for a tool of another shape or a soft body"},
      {"pixel", "is not known; take method = \"auto\", which samples at the pixels of an image"},
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
