#include <cmath>

#include "throw.h"

namespace palpate::stability {
namespace {

scene::Description thrown_cube(double stiffness) {
  return thrown_at(soft_cube(), floor_plane(), 0.5, stiffness);
}

}  // namespace

Row contact_stiffness_row() {
  Row row{"contact-stiffness",
          "k from 1e2 to 1e12 Pa/m: a soft cube thrown on a plane at 0.5 m/s.  Detects motion that differs "
          "from the throw, contact that does not reverse it, and unexplained energy"};
  for (int decade = 2; decade <= 12; decade += 2) {
    const scene::Description thrown = thrown_cube(std::pow(10.0, decade));
    row.cases.push_back({fmt::format("k = 1e{} Pa/m", decade),
                         [thrown](const CaseContext& context) { return expect_thrown(context, thrown); },
                         [thrown](const CaseContext& context) { return projectile_case(context, thrown); }});
  }
  row.core = 2;
  return row;
}

}  // namespace palpate::stability
