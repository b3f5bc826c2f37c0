// Acceptance limits for the cost of a query and of a step with contact, as ratios of one run. Nearest points
// and one thread, unless stated otherwise:
//
//   samples / elements    forces and tangent of all samples over the elements' own assembly            <= 1
//   query / step          from positions of nodes to forces on nodes, over an interactive step of the
//                         first body; for a sphere on the head and on the human              <= 1, 1/20
//   contact / apart       two pumpkins: a step, without its query, over those of each body alone     <= 1.3
//   friction / contact    two pumpkins: the same step with friction 0.3 over that without           <= 1.5
//   real time             touch-head, touch-human and two-pumpkins as the scenes are, on two threads   >= 1
//   image                 the query by the image on hardware                                      <= 0.3 ms
//   growth with skin      exponent in the number of the skin's vertices, region fixed               <= 0.2
//   growth with area      exponent in the region's area, skin fixed                                 <= 1.1
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "product/contact.h"
#include "product/fem.h"

namespace palpate::bench {
namespace {

constexpr int kCores = 2;  ///< Cores of the machine for which real time is required.

bool is_one_of(const std::string& name, std::initializer_list<const char*> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Returns NaN, which meets no limit, if either time was not measured.
double ratio(double ms, double over_ms) { return ms > 0.0 && over_ms > 0.0 ? ms / over_ms : std::nan(""); }

void add_rows(const ContactBenchReport::Scene& scene, std::vector<ContactBar>& out) {
  for (const ContactBenchRow& r : scene.rows) {
    if (r.variant.method == "distance" && r.variant.threads == kCores &&
        is_one_of(scene.name, {"touch-head", "touch-human", "two-pumpkins"}))
      out.push_back({scene.name, "simulated over run time, 2 threads", r.real_time_factor(), 1.0, true});
    if (r.variant.method == "image" && r.variant.threads == 1 && !r.device_is_software)
      out.push_back({scene.name, "image: query [ms]", r.query.median, 0.3});
  }
}

void add_price(const ContactCost& cost, std::vector<ContactBar>& out) {
  const auto add = [&](const char* what, double value, double bar) {
    out.push_back({cost.scene, what, value, bar});
  };
  if (cost.row.touches) add("samples / elements", ratio(cost.row.assembly_ms, cost.row.elements_ms), 1.0);
  add("query / step", ratio(cost.row.to_forces.median, cost.one_body_ms),
      is_one_of(cost.scene, {"touch-head", "touch-human"}) ? 0.05 : 1.0);
  if (cost.scene != "two-pumpkins") return;
  add("contact / apart", ratio(cost.row.step.median, cost.bodies_ms), 1.3);
  add("friction / contact", ratio(cost.friction.symmetric_ms, cost.row.step.median), 1.5);
}

}  // namespace

const ContactBenchRow* ContactBenchReport::Scene::find(const std::string& method, int threads) const {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const ContactBenchRow& r) {
    return r.variant.method == method && r.variant.threads == threads;
  });
  return found == rows.end() ? nullptr : &*found;
}

std::vector<ContactBar> contact_bars(const ContactBenchReport& report) {
  std::vector<ContactBar> out;
  for (const ContactBenchReport::Scene& scene : report.scenes) add_rows(scene, out);
  for (const ContactCost& cost : report.prices) add_price(cost, out);
  for (const ContactGrowth& growth : report.growth)
    out.push_back({"", fmt::format("growth with {}: exponent", growth.with), growth.exponent(),
                   growth.with == "area" ? 1.1 : 0.2});
  return out;
}

}  // namespace palpate::bench
