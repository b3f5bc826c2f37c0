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
          "k from 1e2 to 1e12 Pa/m: a soft cube thrown on a plane at 0.5 m/s.  Finds motion that is not that "
          "of the throw, contact that does not turn it round, energy without a reason"};
  for (int decade = 2; decade <= 12; decade += 2) {
    const scene::Description thrown = thrown_cube(std::pow(10.0, decade));
    row.cases.push_back({fmt::format("k = 1e{} Pa/m", decade),
                         [thrown](const Lab& lab) { return expect_thrown(lab, thrown); },
                         [thrown](const Lab& lab) { return thrown_cell(lab, thrown); }});
  }
  row.core = 2;
  return row;
}

}  // namespace palpate::stability
