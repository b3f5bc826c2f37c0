#include "loop/summary.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "contact/gpu_device.h"
#include "core/clock.h"
#include "core/counters.h"
#include "loop/penetration.h"
#include "palpate/core/named_enum.h"
#include "palpate/device/profile.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "palpate/scene/hands.h"
#include "palpate/tool/tool.h"
#include "proxy/pruner.h"
#include "store/model_cache.h"
#include "tool_instance.h"

namespace palpate::loop {
namespace {

/// Adds all results of one type of number: counts, or times.
template <class Number>
void add_numbers(store::SummarySection& s, const RunResult& result) {
  const auto add = [&s]<class T>(const char* name, const T& value) {
    if constexpr (std::is_same_v<T, Number>)
      s.values.emplace_back(name,
                            static_cast<std::conditional_t<std::is_integral_v<T>, long long, T>>(value));
  };
  visit_counters(add, result);
}

void add_sizes(store::SummarySection& s, const World& world) {
  long long nodes = 0, tets = 0;
  for (const Body& body : world.bodies) {
    nodes += body.rest.nodes.cols();
    tets += body.rest.tets.cols();
  }
  s.values.emplace_back("bodies", static_cast<long long>(world.bodies.size()));
  s.values.emplace_back("nodes", nodes);
  s.values.emplace_back("tetrahedra", tets);
  s.values.emplace_back("peak_memory_mib", peak_memory_mib());
}

void add_options(store::SummarySection& s, const scene::Description& d) {
  if (!d.path.empty())  // else the scene was not read from a file
    s.values.emplace_back("scene_path", std::filesystem::absolute(d.path).lexically_normal().string());
  s.values.emplace_back("integrator", d.integrator.name);
  s.values.emplace_back("rtol", d.integrator.rtol);
  if (const auto used = integrate::error_test_rtol_of(d.integrator))
    s.values.emplace_back("error_test_rtol", *used);
  s.values.emplace_back("step_s", d.integrator.step_s);
  s.values.emplace_back("linear_solver", integrate::linear_solver_of(d.integrator));
  s.values.emplace_back("threads", static_cast<long long>(d.integrator.threads));
  if (!d.tool) return;
  const bool in_state = d.exchange.has_tools_in_state();
  s.values.emplace_back("exchange_scheme", std::string(name_of(d.exchange.scheme)));
  s.values.emplace_back("contact_refresh_s", d.exchange.contact_refresh_s);
  if (!in_state) {
    s.values.emplace_back("exchange_period_s", d.exchange.exchange_period_s);
    s.values.emplace_back("linearisation", d.exchange.linearisation);
  }
  s.values.emplace_back("tool_integrator", in_state ? d.integrator.name : d.tool->integrator);
}

/// Returns the provenance from store, with the libraries of the other parts.
store::Provenance full_provenance() {
  store::Provenance p = store::provenance();
  for (const auto& library : integrate::library_versions()) p.libraries.push_back(library);
  for (const auto& library : linear::library_versions()) p.libraries.push_back(library);
  if (tool::available()) p.libraries.emplace_back("Simbody", tool::simbody_version());
  return p;
}

/// Adds the cached files of models that the scene specifies by "model:NAME".
void add_models(store::Summary& summary, const scene::Description& d) {
  std::set<std::string> added;
  const auto add = [&](const std::string& file) {
    const std::string name = store::name_of_cached(file);
    if (!name.empty() && added.insert(name).second)
      summary.list("models").push_back({{"name", name}, {"file", file}});
  };
  for (const SoftBodySpec& body : d.bodies) add(body.mesh.file);
  for (const scene::Hand& hand : scene::hands_of(d)) add(hand.tool->mesh.file);
}

/// Adds the changes of the resultants on bodies by queries: with images, the pairs and normals of a query
/// hold until the next.
void add_resultants(store::Summary& summary, const World& world) {
  if (!world.contact) return;
  const contact::ContactStatistics& all = world.contact->statistics();
  store::SummaryFields& values = summary.section("contact_resultants").values;
  values = {{"largest_force_jump_n", all.largest_jump.force},
            {"largest_moment_jump_n_m", all.largest_jump.moment},
            {"largest_force_n", all.largest_resultant.force},
            {"largest_moment_n_m", all.largest_resultant.moment}};
  if (all.largest_lagged_friction > 0.0) {
    values.emplace_back("largest_lagged_friction_n", all.largest_lagged_friction);
    values.emplace_back("largest_friction_lag_n", all.largest_friction_lag);
  }
}

/// Adds the work that proxies saved in image contact, over all queries.
void add_pruning(store::SummaryFields& row, const proxy::PruneCounts& c, const World& world,
                 const ContactSpec& contact) {
  row.insert(row.end(), {{"pruned_queries", static_cast<long long>(c.queries)},
                         {"proxy_pairs", static_cast<long long>(c.pairs)},
                         {"pairs_after_boxes", static_cast<long long>(c.after_boxes)},
                         {"pairs_after_hulls", static_cast<long long>(c.after_hulls)},
                         {"regions", static_cast<long long>(c.regions)},
                         {"approaching_regions", static_cast<long long>(c.regions_ahead)},
                         {"rasterised_triangles", std::vector<long long>{c.faces_a, c.faces_b}}});
  const auto mean_share = [&](const std::string& side, long faces) {
    const Body* body = world.find_body(side);  // else a tool
    if (!body || c.queries == 0) return std::nan("");
    return static_cast<double>(faces) /
           (static_cast<double>(c.queries) * static_cast<double>(body->surface_faces().cols()));
  };
  row.emplace_back("mean_rasterised_share", std::vector<double>{mean_share(contact.first, c.faces_a),
                                                                mean_share(contact.second, c.faces_b)});
  row.emplace_back("largest_normal_rotation_rad", c.largest_rotation);
}

/// Adds one row per [[contact]].
void add_contacts(store::Summary& summary, const World& world, const RunResult& result) {
  if (!world.contact) return;
  const std::vector<PenetrationReport> penetrations = penetration_reports(world);
  const std::vector<contact::PairReport> pairs = world.contact->pairs();
  for (std::size_t i = 0; i < penetrations.size(); ++i) {
    const ContactSpec& contact = world.description.contacts[i];
    const PenetrationReport& penetration = penetrations[i];
    const contact::PairReport& pair = pairs[i];
    store::SummaryFields row = {{"between", std::vector<std::string>{contact.first, contact.second}},
                                {"method", pair.method}};
    if (i < result.tunnelled.size())
      row.emplace_back("tunnelled", static_cast<long long>(result.tunnelled[i]));
    row.emplace_back("deepest_overlap_m", penetration.deepest_m);
    if (penetration.quadrature_error > 0.0)
      row.emplace_back("largest_quadrature_error", penetration.quadrature_error);
    if (penetration.largest_share > 0.0)
      row.emplace_back("largest_share_of_a_point", penetration.largest_share);
    row.emplace_back("fast_regions", static_cast<long long>(pair.fast_regions));
    if (pair.stages) {
      row.emplace_back("normals_kept", static_cast<long long>(pair.normals_kept));
      row.emplace_back("images", static_cast<long long>(pair.stages->images));
      row.emplace_back("triangle_pairs", static_cast<long long>(pair.stages->pairs));
    }
    if (pair.pruning) add_pruning(row, *pair.pruning, world, contact);
    summary.list("contacts").push_back(std::move(row));
  }
}

/// Adds one row per tool whose contact with bodies was reduced to points.
void add_reductions(store::Summary& summary, const World& world) {
  for (const AnswerError& e : answer_errors_of(world))
    summary.list("reductions")
        .push_back({{"hand", e.tool},
                    {"requested_error", e.requested},
                    {"largest_error_bound", e.largest},
                    {"mean_error_bound", e.mean},
                    {"exchanges", static_cast<long long>(e.exchanges)},
                    {"exchanges_beyond_requested_error", static_cast<long long>(e.beyond)},
                    {"exchanges_factored", static_cast<long long>(e.factored)}});
}

/// Adds the grasps of the tools.
void add_grasps(store::Summary& summary, const World& world) {
  if (!world.contact) return;
  const contact::GraspCounts& counts = world.contact->statistics().grasps;
  if (counts.closed + counts.empty == 0) return;
  summary.section("grasps").values = {{"closed", static_cast<long long>(counts.closed)},
                                      {"closed_on_nothing", static_cast<long long>(counts.empty)},
                                      {"largest_area_m2", counts.largest_area},
                                      {"final_area_m2", counts.area}};
}

/// Adds the OpenGL device of contact in image space.
void add_renderer(store::Summary& summary, const World& world) {
  if (!world.contact) return;
  const auto pairs = world.contact->pairs();
  const bool images = std::any_of(pairs.begin(), pairs.end(), [](const auto& pair) { return pair.stages; });
  if (const contact::GpuDevice device = contact::gpu_device(); images && !device.name.empty())
    summary.section("renderer").values = {
        {"device", device.name}, {"driver", device.driver}, {"is_software", device.software}};
}

/// Adds the energy balance at the end of the run, if the scene records it.
void add_energy(store::Summary& summary, const RunResult& result) {
  if (!result.energy) return;
  store::SummarySection& s = summary.section("energy");
  visit_energies([&](const char* name, double value) { s.values.emplace_back(name, value); }, *result.energy);
}

/// Adds the vibration of a device's force, and the energy at its port.
void add_vibration_and_port(store::SummaryFields& row, const HandResult& hand) {
  if (hand.buzz_n) row.emplace_back("buzz_above_30_hz_rms_n", *hand.buzz_n);
  if (!hand.port) return;
  row.insert(row.end(),
             {{"port_energy_j", hand.port->energy},
              {"port_least_energy_j", hand.port->least},
              {"port_work_j", hand.port->work},
              {"passivity_controller_dissipated_j", hand.port->controller_dissipated},
              {"passivity_controller_ticks", static_cast<long long>(hand.port->controller_ticks)}});
}

/// Returns the result of a hand, in the numbering of scene::hands_of().
HandResult hand_result(const RunResult& r, std::size_t hand) {
  if (hand == 0)
    return {r.ticks, r.limited_ticks, r.outside_ticks,     r.rejected_ticks,
            r.port,  r.buzz_n,        r.ticks_without_pose};
  return hand <= r.more_hands.size() ? r.more_hands[hand - 1] : HandResult{};  // the run has not ended
}

/// Adds one row per hand: its result, the peaks of the wrench on it, and the counters of its device.
void add_hands(store::Summary& summary, const World& world, const RunResult& result,
               const std::vector<PeakWrench>& peaks) {
  if (!world.description.tool) return;
  const std::vector<scene::Hand> hands = scene::hands_of(world.description);
  for (std::size_t i = 0; i < hands.size(); ++i) {
    const HandResult hand = hand_result(result, i);
    const device::DeviceFigures device = device::figures_of(*hands[i].device);
    store::SummaryFields row = {{"name", hands[i].name},
                                {"ticks", static_cast<long long>(hand.ticks)},
                                {"limited_ticks", static_cast<long long>(hand.limited_ticks)},
                                {"ticks_outside_workspace", static_cast<long long>(hand.outside_ticks)},
                                {"rejected_ticks", static_cast<long long>(hand.rejected_ticks)},
                                {"ticks_without_pose", static_cast<long long>(hand.ticks_without_pose)},
                                {"max_force_n", device.max_force},
                                {"max_torque_n_m", device.max_torque}};
    if (i < peaks.size())
      row.insert(row.end(), {{"peak_force_n", peaks[i].force_n},
                             {"peak_force_at_s", peaks[i].force_at_s},
                             {"peak_torque_n_m", peaks[i].torque_n_m},
                             {"peak_torque_at_s", peaks[i].torque_at_s}});
    add_vibration_and_port(row, hand);
    for (const auto& [name, count] : tallies_of(world, i)) row.emplace_back(name, count);
    summary.list("hands").push_back(std::move(row));
  }
}

/// Adds the timing of a run in real time.
void add_real_time(store::Summary& summary, const RunResult& result) {
  if (!result.real_time) return;
  store::SummarySection& s = summary.section("real_time");
  s.values.emplace_back("scheduling", result.real_time->scheduling);
  s.values.emplace_back("processor", static_cast<long long>(result.real_time->cpu));
  s.values.emplace_back("memory", result.real_time->memory);
  visit_real_time([&](const char* name, auto value) { s.values.emplace_back(name, value); },
                  *result.real_time);
}

}  // namespace

std::vector<std::pair<std::string, long long>> tallies_of(const World& world, std::size_t hand) {
  if (hand >= world.tools.size()) return {};
  return world.tools[hand].device->counters();
}

std::vector<AnswerError> answer_errors_of(const World& world) {
  std::vector<AnswerError> out;
  for (const ToolInstance& tool : world.tools) {
    const PartitionedTool* partitioned = tool.partitioned();
    if (!partitioned || !partitioned->reduction || partitioned->reduction->error_bound().exchanges == 0)
      continue;
    const ReductionError& m = partitioned->reduction->error_bound();
    out.push_back({tool.name, world.description.exchange.linearisation_error, m.largest,
                   m.sum / static_cast<double>(m.exchanges), m.exchanges, m.beyond_wanted, m.factored});
  }
  return out;
}

std::vector<scene::Need> needs(const scene::Description& description) {
  return scene::needs(description, integrate::linear_solver_of(description.integrator));
}

void add_checkpoints(store::Summary& summary, const CheckpointCost& cost, double every_s) {
  summary.section("checkpoints").values = {{"every_s", every_s},
                                           {"written", static_cast<long long>(cost.written)},
                                           {"keep_s", cost.keep_s},
                                           {"reassemble_s", cost.assemble_s}};
}

store::Summary summarise(const World& world, const RunResult& result, double assemble_s,
                         const RunFigures& figures) {
  store::Summary summary;
  summary.scene = world.description.name;
  summary.scene_source = world.description.source;
  summary.outcome = !result.status.ok() ? "failed" : result.stopped ? "interrupted" : "finished";
  summary.message = result.status.message;
  summary.provenance = full_provenance();
  add_options(summary.section("options"), world.description);
  if (const std::string& ordering = result.counters.solver.ordering; !ordering.empty())
    summary.section("options").values.emplace_back("ordering", ordering);
  add_sizes(summary.section("sizes"), world);
  add_models(summary, world.description);
  add_numbers<long>(summary.section("counts"), result);
  if (const long halvings = result.counters.most_halvings; halvings > 0)
    summary.section("sizes").values.emplace_back("smallest_step_part",
                                                 std::ldexp(1.0, -static_cast<int>(halvings)));
  summary.section("timings").values.emplace_back("assemble_s", assemble_s);
  add_numbers<double>(summary.section("timings"), result);
  add_energy(summary, result);
  add_real_time(summary, result);
  add_hands(summary, world, result, figures.peaks());
  add_reductions(summary, world);
  add_grasps(summary, world);
  add_contacts(summary, world, result);
  add_resultants(summary, world);
  add_renderer(summary, world);
  for (const scene::Need& need : needs(world.description))
    summary.list("parts").push_back({{"name", need.part}, {"used", need.used}, {"why", need.why}});
  for (const auto& [name, count] : counters::snapshot())
    summary.list("constructions").push_back({{"name", name}, {"count", static_cast<long long>(count)}});
  return summary;
}

}  // namespace palpate::loop
