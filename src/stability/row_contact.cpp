#include <cmath>

#include "throw.h"

namespace palpate::stability {
namespace {

scene::Description thrown_cube(double stiffness) {
  return thrown_at(soft_cube(), floor_plane(), 0.5, stiffness);
}

StabilityCell run(const Lab& lab, const scene::Description& d) {
  StabilityCell cell;
  judge(lab, run_scene(lab, d, kThrowRtol, 0.0), throw_bars(lab.column, d), cell);
  return cell;
}

}  // namespace

Row contact_stiffness_row() {
  Row row{"contact-stiffness", "k from 1e2 to 1e12 Pa/m: a soft cube thrown on a plane at 0.5 m/s"};
  for (int decade = 2; decade <= 12; decade += 2) {
    const scene::Description thrown = thrown_cube(std::pow(10.0, decade));
    row.cases.push_back({fmt::format("k = 1e{} Pa/m", decade),
                         [thrown](const Lab& lab) { return expect_thrown(lab, thrown); },
                         [thrown](const Lab& lab) { return run(lab, thrown); }});
  }
  return row;
}

}  // namespace palpate::stability
