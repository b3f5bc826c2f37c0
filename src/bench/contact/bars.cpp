// What a query and a step with contact may cost at most, as ratios of one run.  The image on the processor,
// one thread and kBarPixels where nothing else is said:
//
//   samples / elements    forces and tangent of all samples over the elements' own assembly            <= 1
//   query / step          from positions of nodes to forces on nodes, over an interactive step of the
//                         first body; with a sphere on the head and on the human                <= 1, 1/3
//   contact / apart       two pumpkins: a step, without its query, over those of each body alone     <= 1.6
//   friction / contact    two pumpkins: that with friction 0.3 over that without                     <= 1.5
//   samples, regions      eight contacts or more in one solve, pixels as the scene wants      >= 5,000, >= 8
//   real time             touch-head, touch-human and two-pumpkins as the scenes are, on two threads   >= 1
//   gpu / cpu             the same query on a software rasteriser                                      <= 5
//   gpu                   the same query on hardware                                              <= 0.3 ms
//   growth with skin      exponent in the number of the skin's vertices, the region held             <= 0.3
//   growth with area      exponent in the region's area, the skin held                               <= 1.1
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "palpate/bench/contact.h"
#include "palpate/bench/fem.h"

namespace palpate::bench {
namespace {

constexpr int kManyPairs = 8;  ///< in one solve, a region or more of each
constexpr double kThird = 1.0 / 3.0;
constexpr int kCores = 2;  ///< of the machine that real time is asked of

bool is_one_of(const std::string& name, std::initializer_list<const char*> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// NaN, which keeps no bar, where one was not measured.
double ratio(double ms, double over_ms) { return ms > 0.0 && over_ms > 0.0 ? ms / over_ms : std::nan(""); }

void add_rows(const ContactBenchReport::Scene& scene, std::vector<ContactBar>& out) {
  for (const ContactBenchRow& r : scene.rows) {
    if (r.variant.method == "cpu" && r.variant.pixels == 0 && r.variant.threads == kCores &&
        is_one_of(scene.name, {"touch-head", "touch-human", "two-pumpkins"}))
      out.push_back({scene.name, "simulated over run time, 2 threads", r.real_time_factor(), 1.0, true});
    if (r.variant.method != "gpu" || r.variant.pixels != kBarPixels || r.variant.threads != 1) continue;
    if (!r.device_is_software) {
      out.push_back({scene.name, "gpu: query [ms]", r.query.median, 0.3});
      continue;
    }
    if (const ContactBenchRow* cpu = scene.find("cpu", r.variant.pixels, r.variant.threads))
      out.push_back({scene.name, "gpu / cpu: query", ratio(r.query.median, cpu->query.median), 5.0});
  }
}

void add_price(const ContactPrice& price, std::vector<ContactBar>& out) {
  const bool pumpkins = price.scene == "two-pumpkins";
  for (const ContactPrice::Contact& c : price.contacts) {
    const auto add = [&](const char* what, double value, double bar, bool at_least = false) {
      out.push_back({price.scene, what, value, bar, at_least});
    };
    if (c.row.variant.pixels == 0 && price.pairs >= kManyPairs) {
      add("samples in one solve", static_cast<double>(c.row.samples), 5000.0, true);
      add("regions in one solve", c.row.regions, 8.0, true);
    }
    if (c.row.variant.pixels != kBarPixels) continue;
    if (c.row.touches) add("samples / elements", ratio(c.row.assembly_ms, c.row.elements_ms), 1.0);
    add("query / step", ratio(c.row.to_forces.median, price.one_body_ms),
        is_one_of(price.scene, {"touch-head", "touch-human"}) ? kThird : 1.0);
    if (!pumpkins) continue;
    add("contact / apart", ratio(c.row.step.median, price.bodies_ms), 1.6);
    add("friction / contact", ratio(c.friction.symmetric_ms, c.row.step.median), 1.5);
  }
}

}  // namespace

const ContactBenchRow* ContactBenchReport::Scene::find(const std::string& method, int pixels,
                                                       int threads) const {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const ContactBenchRow& r) {
    return r.variant.method == method && r.variant.pixels == pixels && r.variant.threads == threads;
  });
  return found == rows.end() ? nullptr : &*found;
}

std::vector<ContactBar> contact_bars(const ContactBenchReport& report) {
  std::vector<ContactBar> out;
  for (const ContactBenchReport::Scene& scene : report.scenes) add_rows(scene, out);
  for (const ContactPrice& price : report.prices) add_price(price, out);
  for (const ContactGrowth& growth : report.growth) {
    const bool area = growth.with == "area";
    out.push_back({"",
                   fmt::format("growth with {}, {} pixels: exponent", growth.with,
                               growth.pixels > 0 ? std::to_string(growth.pixels) : "wanted"),
                   growth.exponent(), area ? 1.1 : 0.3});
  }
  return out;
}

}  // namespace palpate::bench
