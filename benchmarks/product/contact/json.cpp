#include <cmath>
#include <nlohmann/json.hpp>

#include "product/contact.h"
#include "store/provenance.h"

namespace palpate::bench {
namespace {

using nlohmann::ordered_json;

/// Converts a number to JSON; NaN, which marks a quantity that was not measured, becomes null.
ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(); }

ordered_json json_of(const Spread& spread) {
  return {{"least", spread.least}, {"median", spread.median}, {"p99", spread.p99}};
}

ordered_json json_of(const ContactBenchRow& r) {
  ordered_json stages;
  for (int s = 0; s < kContactStages; ++s) {
    const auto stage = static_cast<ContactStage>(s);
    stages[std::string(name_of(stage))] = json_of(r.of(stage));
  }
  return {{"method", r.variant.method},
          {"device", r.device},
          {"device_is_software", r.device_is_software},
          {"threads", r.variant.threads},
          {"tetrahedra", r.tetrahedra},
          {"skin_vertices", r.skin_vertices},
          {"periods", r.periods},
          {"touches", r.touches},
          {"samples", r.samples},
          {"regions", r.regions},
          {"images", r.images},
          {"query_ms", json_of(r.query)},
          {"query_and_forces_ms", json_of(r.to_forces)},
          {"stages_ms", stages},
          {"step_ms", json_of(r.step)},
          {"period_ms", json_of(r.period)},
          {"linearise_ms", r.linearise_ms},
          {"solve_ms", r.solve_ms},
          {"samples_assembly_ms", r.assembly_ms},
          {"elements_assembly_ms", r.elements_ms},
          {"real_time_factor", r.real_time_factor()}};
}

ordered_json json_of(const ContactCost& p) {
  ordered_json contact = json_of(p.row);
  contact["friction_step_ms"] = p.friction.symmetric_ms;
  contact["friction_full_tangent_step_ms"] = p.friction.full_ms;
  contact["friction_left_out_of_a_step"] = p.friction.left_out;
  contact["force_change_by_symmetric_tangent"] = p.friction.force_change;
  return {{"scene", p.scene},
          {"one_body_step_ms", p.one_body_ms},
          {"bodies_apart_step_ms", p.bodies_ms},
          {"contact_free_step_ms", p.contact_free_ms},
          {"contact", contact}};
}

ordered_json json_of(const ContactGrowth& g) {
  ordered_json rows = ordered_json::array();
  for (const ContactGrowthRow& r : g.rows)
    rows.push_back({{"skin_vertices", r.skin_vertices},
                    {"area_m2", r.area_m2},
                    {"samples", r.samples},
                    {"query_ms", json_of(r.query)}});
  return {{"with", g.with}, {"exponent", number(g.exponent())}, {"rows", rows}};
}

ordered_json json_of(const ContactBar& b) {
  return {{"scene", b.scene},
          {"what", b.what},
          {"value", number(b.value)},
          {b.at_least ? "at_least" : "at_most", b.bar},
          {"met", b.is_met()}};
}

ordered_json json_of(const ContactBenchReport::Scene& s);

template <class T>
ordered_json list_of(const std::vector<T>& values) {
  ordered_json out = ordered_json::array();
  for (const T& value : values) out.push_back(json_of(value));
  return out;
}

ordered_json json_of(const ContactBenchReport::Scene& s) {
  return {{"scene", s.name}, {"rows", list_of(s.rows)}};
}

}  // namespace

std::string to_json(const ContactBenchReport& report) {
  const store::Provenance p = store::provenance();
  ordered_json out{{"version", p.version},        {"commit", p.commit}, {"compiler", p.compiler},
                   {"build_type", p.build_type},  {"processor", p.cpu}, {"cores", p.cores},
                   {"started_utc", p.started_utc}};
  if (!report.no_image.empty()) out["image_left_out"] = report.no_image;
  out["scenes"] = list_of(report.scenes);
  out["prices"] = list_of(report.prices);
  out["growth"] = list_of(report.growth);
  out["bars"] = list_of(contact_bars(report));
  return out.dump(2) + "\n";
}

}  // namespace palpate::bench
