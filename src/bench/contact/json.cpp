#include <nlohmann/json.hpp>

#include "palpate/bench/contact.h"

namespace palpate::bench {
namespace {

using Json = nlohmann::ordered_json;

Json of(const Spread& spread) {
  return {{"least", spread.least}, {"median", spread.median}, {"p99", spread.p99}};
}

Json of(const ContactBenchRow& r) {
  Json device = {{"name", r.device.name}};
  if (!r.device.driver.empty()) device["driver"] = r.device.driver;
  if (!r.device.instructions.empty()) device["instructions"] = r.device.instructions;
  return {{"method", r.variant.method},
          {"device", device},
          {"pixels", r.variant.pixels},
          {"threads", r.variant.threads},
          {"tetrahedra", r.tetrahedra},
          {"skin_vertices", r.skin_vertices},
          {"periods", r.periods},
          {"touches", r.touches},
          {"samples", r.samples},
          {"regions", r.regions},
          {"images", r.images},
          {"query_ms", of(r.query)},
          {"step_ms", of(r.step)},
          {"period_ms", of(r.period)},
          {"positions_ms", r.positions_ms},
          {"regions_ms", r.regions_ms},
          {"patches_ms", r.patches_ms},
          {"images_ms", r.images_ms},
          {"gaps_ms", r.gaps_ms},
          {"grouping_ms", r.grouping_ms},
          {"force_ms", r.force_ms},
          {"tangent_ms", r.tangent_ms},
          {"assembly_ms", r.assembly_ms},
          {"elements_ms", r.elements_ms},
          {"linearise_ms", r.linearise_ms},
          {"solve_ms", r.solve_ms},
          {"query_bytes", r.query_bytes},
          {"period_s", r.period_s},
          {"real_time_factor", r.real_time_factor()}};
}

Json of(const ContactPrice& p) {
  Json out = {{"contact", of(p.contact)},
              {"one_body_ms", p.one_body_ms},
              {"bodies_ms", p.bodies_ms},
              {"contact_free_ms", p.contact_free_ms}};
  if (p.friction_ms > 0.0)
    out["friction"] = {{"symmetric_ms", p.friction_ms},
                       {"full_ms", p.friction_full_ms},
                       {"left_out", p.friction_left_out},
                       {"force_change", p.friction_force_change}};
  return out;
}

}  // namespace

std::string to_json(const std::vector<ContactBenchScene>& scenes) {
  Json out = Json::array();
  for (const ContactBenchScene& scene : scenes) {
    Json one = {{"scene", scene.name}, {"rows", Json::array()}};
    for (const ContactBenchRow& row : scene.rows) one["rows"].push_back(of(row));
    for (const ContactPrice& price : scene.price) one["price"] = of(price);
    out.push_back(std::move(one));
  }
  return Json{{"scenes", out}}.dump(2) + "\n";
}

}  // namespace palpate::bench
