#include "contact/methods.h"

#include <fmt/ranges.h>

namespace palpate::contact {

const std::vector<MethodEntry>& method_registry() {
  static const std::vector<MethodEntry> registry = {
      {"analytic", "exact gaps between vertices and obstacles, or tools with shape = \"sphere\"", {}},
      {"auto", "\"distance\", or \"image\" where pixels is set", part_keys({"pixels", "quadrature_error"})},
      {"distance",
       "nearest points between material points of one skin and the other surface: continuous force, the "
       "gradient of an energy; for soft bodies (self-contact too), tools of any shape and obstacles",
       part_keys({"quadrature_error"})},
      {"image",
       "penetration depths at the vertices of soft bodies from depth images (Galoppo et al. 2007): for tools "
       "of any shape and other soft bodies; by OpenGL, without a GPU by Mesa's software rasteriser",
       part_keys({"pixels"})},
  };
  return registry;
}

const std::vector<AbsentMethod>& absent_methods() {
  static const std::vector<AbsentMethod> absent = {
      {"cpu", "has been removed; use \"distance\" or \"image\""},
      {"gpu", "has been renamed; use \"image\""},
      {"exact", "has been removed; use \"distance\""},
      {"vertex", "does not exist; \"analytic\" and \"image\" sample at vertices"},
      {"pixel", "does not exist; use \"image\""},
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

const std::vector<SpringEntry>& spring_registry() {
  static const std::vector<SpringEntry> registry = {
      {"per_area", "pressure as a function of depth: the force does not depend on the mesh",
       part_keys({"stiffness_pa_m", "damping_pa_s_m"})},
      {"per_point",
       "one spring per colliding vertex (Galoppo et al. 2007): the force grows with their number",
       part_keys({"stiffness_n_m", "damping_n_s_m"})},
  };
  return registry;
}

const std::vector<LawEntry>& law_registry() {
  static const std::vector<LawEntry> registry = {
      {"kelvin_voigt", "spring and damper in parallel", part_keys({"damping_pa_s_m", "damping_n_s_m"})},
      {"hunt_crossley", "damping proportional to the elastic pressure", part_keys({"hunt_crossley_s_m"})},
  };
  return registry;
}

}  // namespace palpate::contact
