#include "palpate/contact/methods.h"

#include <fmt/ranges.h>

namespace palpate::contact {

namespace {

std::vector<PartKey> image_keys() { return part_keys({"pixels", "quadrature_error", "samples", "depths"}); }

std::vector<PartKey> all_keys() {
  return part_keys({"gaps", "pixels", "quadrature_error", "samples", "depths"});
}

}  // namespace

const std::vector<MethodEntry>& method_registry() {
  static const std::vector<MethodEntry> registry = {
      {"analytic", "exact gaps at the vertices: of obstacles, and of tools with shape = \"sphere\"",
       part_keys({"gaps"})},
      {"auto", "\"distance\"; \"image\" where pixels, samples or depths are given", all_keys()},
      {"distance",
       "material points of skins and their nearest points on what they touch: the gradient of an energy, "
       "continuous; of soft bodies, themselves too, tools of any shape and obstacles",
       part_keys({"gaps", "quadrature_error"})},
      {"image",
       "image space: tools of any shape, other soft bodies, a body's bones against each other; on a GPU "
       "where the machine has one, else on the processor",
       image_keys()},
      {"cpu", "the same image on the processor", image_keys()},
      {"gpu", "the same image by OpenGL, without a GPU by Mesa's software rasteriser", image_keys()},
      {"exact",
       "no image: a line through each pixel or vertex, in double, and all layers that it meets; slow",
       image_keys()},
  };
  return registry;
}

const std::vector<AbsentMethod>& absent_methods() {
  static const std::vector<AbsentMethod> absent = {
      {"vertex",
       "is no method; obstacles and spheres are sampled at the vertices by method = \"analytic\", and for a "
       "tool of another shape or a soft body write samples = \"vertex\""},
      {"pixel", "is no method; write samples = \"pixel\", with any method in image space"},
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
